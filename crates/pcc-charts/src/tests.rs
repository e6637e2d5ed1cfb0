//! Properties of whole pictures.

use super::*;
use proptest::prelude::*;

fn chart(x: Axis, y: Axis, series: Vec<Series>) -> Chart {
    Chart { title: "T".to_string(), description: "D".to_string(), x, y, series, guides: Vec::new() }
}

fn both_linear(marks: Marks) -> Chart {
    chart(Axis::linear("x"), Axis::linear("y"), vec![Series::new("s", Color::Blue, marks)])
}

/// The names of all elements, after checking that every one is closed and no text looks like markup.
fn elements(svg: &str) -> Vec<String> {
    let (mut open, mut all) = (Vec::new(), Vec::new());
    for part in svg.split('<').skip(1) {
        let (tag, text) = part.split_once('>').expect("every tag ends");
        assert!(!text.contains('>') || text.starts_with("\n.chart"), "stray markup in {text:?}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default().to_string();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.starts_with('?') {
            assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
            all.push(name.clone());
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty());
    all
}

/// The data of all paths of a class.
fn paths<'a>(svg: &'a str, class: &str) -> Vec<&'a str> {
    let start = format!("<path class=\"{class}\" d=\"");
    svg.split(&start).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn hostile_names_become_text() {
    let hostile = "</text><script>alert(\"1\")</script>&\u{0}'";
    let mut chart = both_linear(Marks::Line(vec![[0.0, 0.0], [1.0, 1.0]]));
    chart.series.push(Series::new(hostile, Color::Red, Marks::Symbols(vec![[0.5, 0.5]], Symbol::Circle)));
    for text in [&mut chart.title, &mut chart.description, &mut chart.x.label, &mut chart.y.label] {
        *text = hostile.to_string();
    }
    chart.guides = vec![Guide::Vertical(0.5, hostile.to_string()), Guide::Horizontal(0.5, hostile.to_string())];
    for svg in [chart.to_svg(hostile), sheet(hostile, hostile, &[chart.clone(), chart.clone()], 0)] {
        let elements = elements(&svg);
        let expected = ["svg", "title", "desc", "style", "clipPath", "g", "path", "text"];
        assert!(elements.iter().all(|name| expected.contains(&name.as_str())), "{elements:?}");
        assert!(svg.contains("&lt;script&gt;"));
    }
}

#[test]
fn broken_numbers_are_skipped() {
    let broken = vec![[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [f64::INFINITY, 3.0], [4.0, 5.0], [5.0, 6.0]];
    let lines = both_linear(Marks::Line(broken.clone())).to_svg("a");
    assert_eq!(paths(&lines, "chart-line")[0].matches('M').count(), 2);
    let mut logarithmic = both_linear(Marks::Points(broken));
    logarithmic.x.scale = Scale::Logarithmic;
    assert_eq!(paths(&logarithmic.to_svg("a"), "chart-points")[0].matches("h0").count(), 3);
}

#[test]
fn nothing_to_draw_is_said() {
    let empty = [Vec::new(), vec![[f64::NAN, 1.0]]].map(|points| both_linear(Marks::Points(points)));
    for chart in empty {
        assert!(chart.to_svg("a").contains(">no data</text>"));
    }
    assert!(!both_linear(Marks::Points(vec![[0.0, 0.0]])).to_svg("a").contains("no data"));
    elements(&sheet("", "", &[], 3));
}

#[test]
fn no_numbers_upset_any_kind_of_marks() {
    let extremes = [0.0, -0.0, 1.0, -5.0, 1e300, -1e300, f64::MAX, f64::MIN, 1e-300, 5e-324, f64::NAN, f64::INFINITY];
    let points: Vec<[f64; 2]> = extremes.iter().flat_map(|&x| extremes.map(|y| [x, y])).collect();
    let bars = extremes.iter().map(|&value| Bar { category: 1, value, interval: Some((value, -value)) }).collect();
    let names = || vec!["a".to_string(), "b".repeat(99)];
    let marks = [
        Marks::Points(points.clone()),
        Marks::Symbols(points.clone(), Symbol::Diamond),
        Marks::Line(points.clone()),
        Marks::Area(points.clone()),
        Marks::Bars(bars),
        Marks::Cells(Cells { x: extremes.to_vec(), y: extremes.to_vec(), values: extremes.repeat(12) }),
    ];
    let scales = || [Axis::linear("x"), Axis::logarithmic("x"), Axis::categories("x", names())];
    for (x, y) in scales().into_iter().flat_map(|x| scales().map(|y| (x.clone(), y))) {
        for [low, high] in points.iter().step_by(7) {
            let series = marks.iter().map(|marks| Series::new("", Color::Gray, marks.clone())).collect();
            let mut chart = chart(x.clone().between(*low, *high), y.clone(), series);
            chart.guides =
                vec![Guide::Vertical(*low, "v".into()), Guide::Horizontal(*high, "h".into()), Guide::Diagonal];
            let svg = chart.to_svg("a");
            elements(&svg);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{x:?} {low} {high}");
        }
    }
}

#[test]
fn ten_thousand_points_stay_small() {
    let points = (0..10_000).map(|index| [f64::from(index), f64::from(index * 7919 % 10_007)]).collect();
    let svg = both_linear(Marks::Points(points)).to_svg("a");
    assert!(svg.len() < 150_000, "{}", svg.len());
    assert_eq!(paths(&svg, "chart-points").len(), 1);
}

#[test]
fn identifiers_in_a_sheet_are_unique() {
    let charts = vec![both_linear(Marks::Line(vec![[0.0, 0.0], [1.0, 1.0]])); 30];
    let svg = sheet("Sheet", "Thirty panels.", &charts, 4);
    let mut identifiers: Vec<&str> = svg.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let all = identifiers.len();
    identifiers.sort_unstable();
    identifiers.dedup();
    assert_eq!((all, identifiers.len()), (2 + 30 * 3, 2 + 30 * 3));
}

#[test]
fn bars_of_several_series_lie_side_by_side() {
    let bars = |value| Marks::Bars(vec![Bar { category: 0, value, interval: None }]);
    let series = vec![Series::new("a", Color::Blue, bars(1.0)), Series::new("b", Color::Red, bars(2.0))];
    let svg = chart(Axis::linear(""), Axis::categories("", vec!["only".to_string()]), series).to_svg("a");
    let tops: Vec<f64> = paths(&svg, "chart-bars")
        .iter()
        .filter(|path| path.matches('L').count() == 3)
        .map(|path| path[1..].split([' ', 'L']).nth(1).unwrap().parse().unwrap())
        .collect();
    // The first two are in the plot area, the others in the legend.
    assert!(tops.len() == 4 && tops[1] - tops[0] > 10.0, "{tops:?}");
}

/// A map like that of a stability limit, with noise as from random samples.
fn map(size: u32, noise: f64) -> Cells {
    let centres: Vec<f64> = (0..size).map(|index| f64::from(index) / f64::from(size)).collect();
    let share = |x: f64, y: f64| 1.0 / (1.0 + (12.0 * (x * x + y - 0.9 - 0.2 * (7.0 * x).sin())).exp());
    let random = |index: usize| (index * 7919 % 10_007) as f64 / 10_007.0 - 0.5;
    let places = centres.iter().flat_map(|&y| centres.iter().map(move |&x| (x, y)));
    let values = places.enumerate().map(|(index, (x, y))| share(x, y) + noise * random(index)).collect();
    Cells { x: centres.clone(), y: centres, values }
}

#[test]
fn maps_stay_small() {
    let size = |size, noise| both_linear(Marks::Cells(map(size, noise))).to_svg("a").len();
    for (cells, noise, largest) in
        [(101, 0.0, 40_000), (101, 0.1, 100_000), (1001, 0.0, 150_000), (1001, 2.0, 2_500_000)]
    {
        let found = size(cells, noise);
        assert!(found < largest, "{cells} with noise {noise}: {found}");
    }
}

#[test]
fn cells_fill_the_axes_without_a_margin() {
    let cells = Cells { x: vec![0.0, 1.0], y: vec![5.0], values: vec![0.2, 0.8] };
    let svg = both_linear(Marks::Cells(cells)).to_svg("a");
    let clip = paths(&svg, "chart-clip")[0];
    let corner = clip.split('L').next().unwrap().trim_start_matches('M');
    let corner: Vec<f64> = corner.split(' ').map(|number| number.parse().unwrap()).collect();
    let start = format!("m{:.0} {:.0}v3000", corner[0] * 10.0, corner[1] * 10.0);
    assert!(paths(&svg, "chart-level-2")[0].starts_with(&start), "{clip}");
    // In the plot area and in the scale, which has all levels.
    assert_eq!((paths(&svg, "chart-level-8").len(), paths(&svg, "chart-level-0").len()), (2, 1));
}

#[test]
fn lines_over_cells_stand_out() {
    let mut chart = both_linear(Marks::Line(vec![[0.0, 0.0], [1.0, 1.0]]));
    assert!(!chart.to_svg("a").contains("chart-halo"));
    chart.series.insert(0, Series::new("", Color::Blue, Marks::Cells(map(5, 0.0))));
    chart.guides.push(Guide::Diagonal);
    assert_eq!(paths(&chart.to_svg("a"), "chart-halo").len(), 2);
}

/// Any number, special ones more often than they would come.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1.0..2.0f64, any::<f64>(), proptest::sample::select(vec![0.0, 1.0, f64::NAN, f64::MAX, 5e-324])]
}

proptest! {
    #[test]
    fn no_cells_upset_a_chart(
        x in prop::collection::vec(number(), 0..9), y in prop::collection::vec(number(), 0..9),
        values in prop::collection::vec(number(), 0..99), scales in [0..3usize, 0..3usize],
        range in prop::option::of((number(), number())), name in ".{0,40}",
    ) {
        let axis = |scale| match scale {
            0 => Axis::linear("x"),
            1 => Axis::logarithmic("x"),
            _ => Axis::categories("x", vec!["a".to_string(), "b".to_string()]),
        };
        let series = Series::new(name, Color::Gray, Marks::Cells(Cells { x, y, values }));
        let mut chart = chart(axis(scales[0]), axis(scales[1]), vec![series]);
        chart.x.range = range;
        let svg = chart.to_svg("a");
        elements(&svg);
        for class in ["chart-axis", "chart-level-0", "chart-level-9"] {
            prop_assert!(paths(&svg, class).iter().all(|path| !path.contains(['N', 'i'])));
        }
        let lines = chart.to_csv().lines().count();
        let Marks::Cells(cells) = &chart.series[0].marks else { unreachable!() };
        prop_assert!(lines > cells.values.len().min(cells.x.len() * cells.y.len()));
    }
}
