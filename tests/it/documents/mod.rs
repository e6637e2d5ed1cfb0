//! What the documents show and say is true: sessions are run, studies are read, links are followed.

mod console;
mod form;
mod json;
mod links;
mod pages;
mod studies;
