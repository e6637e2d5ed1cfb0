//! The style sheet.

/// Style sheet for all charts: colours for light and dark surroundings, fonts and line widths.
///
/// Everything hangs on custom properties of `.chart`, which a page may set to other values. Printed charts are light.
// Dark applies to screens only, which leaves light for print.
//
// The levels of cells go from the paper to its opposite in lightness, so that their order survives grey prints and
// every kind of colour blindness. Amber below one half and blue from there on, which red-, green- and blue-blind
// readers tell apart, show where that border is. Edges are crisp because smoothed ones of neighbours would let the
// paper through.
pub const STYLE: &str = "\
.chart {
  --chart-paper: #ffffff;
  --chart-ink: #1c2127;
  --chart-muted: #545c66;
  --chart-axis: #868e98;
  --chart-grid: #e7e9ec;
  --chart-blue: #1957bb;
  --chart-red: #bd3713;
  --chart-green: #549f73;
  --chart-orange: #cd7f15;
  --chart-purple: #af60a9;
  --chart-teal: #005064;
  --chart-gray: #66686a;
  --chart-level-0: #fbeec9;
  --chart-level-1: #f5dca6;
  --chart-level-2: #efca86;
  --chart-level-3: #e7b76a;
  --chart-level-4: #dea553;
  --chart-level-5: #5a93bb;
  --chart-level-6: #3d7fb3;
  --chart-level-7: #276aa9;
  --chart-level-8: #1c5699;
  --chart-level-9: #154286;
  display: block;
  max-width: 100%;
  height: auto;
  font-family: Inter, \"Helvetica Neue\", Arial, \"Liberation Sans\", \"DejaVu Sans\", sans-serif;
  font-size: 12px;
  font-variant-numeric: tabular-nums;
}
@media screen and (prefers-color-scheme: dark) {
  .chart {
    --chart-paper: #15181c;
    --chart-ink: #e8eaed;
    --chart-muted: #a8b0ba;
    --chart-axis: #747d88;
    --chart-grid: #2a2f36;
    --chart-blue: #508ff8;
    --chart-red: #e35f3c;
    --chart-green: #57dd9b;
    --chart-orange: #fea80a;
    --chart-purple: #b95fb1;
    --chart-teal: #aaeaff;
    --chart-gray: #9aa2ae;
    --chart-level-0: #3c2a13;
    --chart-level-1: #4e3614;
    --chart-level-2: #624213;
    --chart-level-3: #754e14;
    --chart-level-4: #895b16;
    --chart-level-5: #508cc7;
    --chart-level-6: #65a2db;
    --chart-level-7: #7eb8eb;
    --chart-level-8: #9bcef8;
    --chart-level-9: #c1e3fe;
  }
}
.chart-blue { --chart-color: var(--chart-blue); }
.chart-red { --chart-color: var(--chart-red); }
.chart-green { --chart-color: var(--chart-green); }
.chart-orange { --chart-color: var(--chart-orange); }
.chart-purple { --chart-color: var(--chart-purple); }
.chart-teal { --chart-color: var(--chart-teal); }
.chart-gray { --chart-color: var(--chart-gray); }
.chart-level-0 { fill: var(--chart-level-0); }
.chart-level-1 { fill: var(--chart-level-1); }
.chart-level-2 { fill: var(--chart-level-2); }
.chart-level-3 { fill: var(--chart-level-3); }
.chart-level-4 { fill: var(--chart-level-4); }
.chart-level-5 { fill: var(--chart-level-5); }
.chart-level-6 { fill: var(--chart-level-6); }
.chart-level-7 { fill: var(--chart-level-7); }
.chart-level-8 { fill: var(--chart-level-8); }
.chart-level-9 { fill: var(--chart-level-9); }
.chart-paper { fill: var(--chart-paper); }
.chart-grid, .chart-axis, .chart-guide, .chart-line, .chart-points, .chart-whiskers, .chart-halo { fill: none; }
.chart-grid { stroke: var(--chart-grid); stroke-width: 1px; }
.chart-axis { stroke: var(--chart-axis); stroke-width: 1px; }
.chart-guide { stroke: var(--chart-ink); stroke-width: 1px; stroke-dasharray: 5 3; }
.chart-line { stroke: var(--chart-color); stroke-width: 1.6px; stroke-linecap: round; stroke-linejoin: round; }
.chart-points { stroke: var(--chart-color); stroke-width: 2.4px; stroke-linecap: round; stroke-opacity: 0.75; }
.chart-symbols { fill: var(--chart-color); }
.chart-area { fill: var(--chart-color); fill-opacity: 0.18; }
.chart-bars { fill: var(--chart-color); fill-opacity: 0.85; }
.chart-whiskers { stroke: var(--chart-ink); stroke-width: 1px; }
.chart-cells { shape-rendering: crispEdges; }
.chart-halo { stroke: var(--chart-paper); stroke-width: 4px; stroke-opacity: 0.8; stroke-linejoin: round; }
.chart-over .chart-symbols { stroke: var(--chart-paper); stroke-width: 2px; paint-order: stroke; }
.chart text { fill: var(--chart-ink); }
.chart text.chart-tick, .chart text.chart-empty { fill: var(--chart-muted); }
.chart-label, .chart-empty { font-size: 13px; }
.chart-heading { font-size: 14px; font-weight: 600; }
.chart-title { font-size: 18px; font-weight: 600; }
.chart-note { font-size: 11.5px; }
.chart-note, .chart-empty {
  stroke: var(--chart-paper);
  stroke-width: 3px;
  stroke-linejoin: round;
  paint-order: stroke;
}
";

#[cfg(test)]
mod tests {
    use super::super::{Color, levels, marks};
    use super::*;

    /// The values of a custom property: light, then dark.
    fn values(name: &str) -> Vec<u32> {
        let start = format!("--{name}: #");
        let values = STYLE.lines().filter_map(|line| line.trim().strip_prefix(&start));
        values.map(|value| u32::from_str_radix(value.trim_end_matches(';'), 16).unwrap()).collect()
    }

    /// Red, green and blue as linear light.
    fn light(color: u32) -> [f64; 3] {
        [16, 8, 0].map(|shift| match f64::from(color >> shift & 0xff) / 255.0 {
            dark if dark <= 0.04045 => dark / 12.92,
            bright => ((bright + 0.055) / 1.055).powf(2.4),
        })
    }

    /// Relative luminance as the Web Content Accessibility Guidelines define it.
    fn luminance(color: u32) -> f64 {
        let [red, green, blue] = light(color);
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    fn contrasts(name: &str) -> Vec<f64> {
        let pairs = values(name).into_iter().zip(values("chart-paper"));
        let sorted = pairs.map(|(one, other)| (luminance(one), luminance(other)));
        sorted.map(|(one, other)| (one.max(other) + 0.05) / (one.min(other) + 0.05)).collect()
    }

    #[test]
    fn colours_stand_out_from_light_and_from_dark_paper() {
        for (names, least) in [(Color::ALL.map(marks::class).to_vec(), 3.0), (vec!["chart-ink", "chart-muted"], 4.5)] {
            for name in names {
                let contrasts = contrasts(name);
                assert_eq!(contrasts.len(), 2, "{name}");
                assert!(contrasts.iter().all(|contrast| *contrast >= least), "{name}: {contrasts:?}");
            }
        }
    }

    type Matrix = [[f64; 3]; 3];

    const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// Linear light as full protanopes, deuteranopes and tritanopes see it (Machado, Oliveira and Fernandes 2009).
    const DEFICIENCIES: [Matrix; 3] = [
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    fn times(matrix: Matrix, vector: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(vector).map(|(one, other)| one * other).sum())
    }

    /// Coordinates in the Oklab space, where distances are those that are seen.
    fn oklab(light: [f64; 3]) -> [f64; 3] {
        let cones = [
            [0.412_221_5, 0.536_332_5, 0.051_446_0],
            [0.211_903_5, 0.680_699_5, 0.107_397_0],
            [0.088_302_5, 0.281_718_8, 0.629_978_7],
        ];
        let opponents = [
            [0.210_454_3, 0.793_617_8, -0.004_072_0],
            [1.977_998_5, -2.428_592_2, 0.450_593_7],
            [0.025_904_0, 0.782_771_8, -0.808_675_8],
        ];
        times(opponents, times(cones, light.map(|channel| channel.clamp(0.0, 1.0))).map(f64::cbrt))
    }

    #[test]
    fn colours_stay_apart_for_colour_blind_readers() {
        for (scheme, seen_by) in [0, 1].into_iter().flat_map(|scheme| DEFICIENCIES.map(|matrix| (scheme, matrix))) {
            let seen = |color| oklab(times(seen_by, light(values(marks::class(color))[scheme])));
            for (index, color) in Color::ALL.into_iter().enumerate() {
                for other in Color::ALL.into_iter().skip(index + 1) {
                    let squares = seen(color).into_iter().zip(seen(other)).map(|(one, other)| (one - other).powi(2));
                    let distance = squares.sum::<f64>().sqrt();
                    assert!(distance > 0.06, "{color:?} and {other:?}: {distance}");
                }
            }
        }
    }

    #[test]
    fn levels_are_in_order_of_lightness_for_all_readers() {
        let cases = [0, 1].into_iter().flat_map(|scheme| DEFICIENCIES.map(|matrix| (scheme, matrix)));
        for (scheme, seen_by) in cases.chain([(0, IDENTITY), (1, IDENTITY)]) {
            let lightness = |name: &&str| oklab(times(seen_by, light(values(name)[scheme])))[0];
            let all: Vec<f64> = ["chart-paper"].iter().chain(&levels::CLASSES).map(lightness).collect();
            let sign = (all[10] - all[0]).signum();
            let steps: Vec<f64> = all.windows(2).map(|pair| (pair[1] - pair[0]) * sign).collect();
            assert!(steps.iter().all(|step| *step > 0.04), "scheme {scheme}: {steps:?}");
        }
    }

    #[test]
    fn levels_below_and_above_one_half_differ_in_hue() {
        for (scheme, seen_by) in [0, 1].into_iter().flat_map(|scheme| DEFICIENCIES.map(|matrix| (scheme, matrix))) {
            let seen = |level: usize| oklab(times(seen_by, light(values(levels::CLASSES[level])[scheme])));
            let [[_, low_a, low_b], [_, high_a, high_b]] = [seen(4), seen(5)];
            let distance = (low_a - high_a).hypot(low_b - high_b);
            assert!(distance > 0.1, "scheme {scheme}: {distance}");
        }
    }

    #[test]
    fn the_style_sheet_needs_nothing_from_elsewhere() {
        assert!(!STYLE.contains(['<', '&']) && !STYLE.contains("url(") && !STYLE.contains("@import"));
    }
}
