//! The style sheet.

/// Style sheet for all charts: colours for light and dark surroundings, fonts and line widths.
///
/// Everything hangs on custom properties of `.chart`, which a page may set to other values. Printed charts are light.
// Dark applies to screens only, which leaves light for print.
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
  }
}
.chart-blue { --chart-color: var(--chart-blue); }
.chart-red { --chart-color: var(--chart-red); }
.chart-green { --chart-color: var(--chart-green); }
.chart-orange { --chart-color: var(--chart-orange); }
.chart-purple { --chart-color: var(--chart-purple); }
.chart-teal { --chart-color: var(--chart-teal); }
.chart-gray { --chart-color: var(--chart-gray); }
.chart-paper { fill: var(--chart-paper); }
.chart-grid, .chart-axis, .chart-guide, .chart-line, .chart-points, .chart-whiskers { fill: none; }
.chart-grid { stroke: var(--chart-grid); stroke-width: 1px; }
.chart-axis { stroke: var(--chart-axis); stroke-width: 1px; }
.chart-guide { stroke: var(--chart-ink); stroke-width: 1px; stroke-dasharray: 5 3; }
.chart-line { stroke: var(--chart-color); stroke-width: 1.6px; stroke-linecap: round; stroke-linejoin: round; }
.chart-points { stroke: var(--chart-color); stroke-width: 2.4px; stroke-linecap: round; stroke-opacity: 0.75; }
.chart-symbols { fill: var(--chart-color); }
.chart-area { fill: var(--chart-color); fill-opacity: 0.18; }
.chart-bars { fill: var(--chart-color); fill-opacity: 0.85; }
.chart-whiskers { stroke: var(--chart-ink); stroke-width: 1px; }
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
    use super::super::{Color, marks};
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
    fn the_style_sheet_needs_nothing_from_elsewhere() {
        assert!(!STYLE.contains(['<', '&']) && !STYLE.contains("url(") && !STYLE.contains("@import"));
    }
}
