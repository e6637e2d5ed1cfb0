//! Evaluation allocates nothing.
#![allow(unsafe_code, reason = "an allocator that counts is unsafe")]

use pcc_expressions::Compiler;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

thread_local! {
    /// Allocations of this thread.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: Every call is passed on to the system's allocator; counting neither allocates nor panics.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: The caller's duties are the same.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: The caller's duties are the same.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> usize {
    ALLOCATIONS.with(Cell::get)
}

#[test]
fn evaluation_does_not_allocate() {
    let mut compiler = Compiler::new(&["x", "y"]).unwrap();
    compiler.define("z", "x^3.5*y + max(x, abs(y))").unwrap();
    for text in ["sin(z)*exp(-x)", "x^7 + z^y", "atan2(y, z)/sqrt(x)", "3", "x"] {
        compiler.expression(text).unwrap();
    }
    let program = compiler.finish().unwrap();
    let mut workspace = program.workspace();
    let before = allocations();
    for i in 0..100 {
        let point = [1.0 + f64::from(i), 2.0];
        black_box(program.evaluate(&point, &mut workspace));
        black_box(program.differentiate(&point, &mut workspace));
    }
    assert_eq!(allocations(), before);
    black_box(Box::new(1.0));
    assert_eq!(allocations(), before + 1, "allocations are counted");
}
