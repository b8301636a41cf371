//! Goal: maps show every particle where it is, in the colour of its value, whatever the data are.

use super::pictures::check;
use crate::output::{MapPanel, StripFrame, draw_maps, draw_strip};

const LOWEST: &str = "#440154";
const HIGHEST: &str = "#fde725";
const UNIT_SQUARE: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 1.0]];
/// Colours, one tile each, of a bar.
const BAR: usize = 64;

fn panel(bounds: [[f64; 2]; 2], points: Vec<[f64; 2]>, values: Vec<f64>) -> MapPanel {
    MapPanel {
        name: "stress <x> & y".into(),
        unit: "Pa".into(),
        axes: ["x", "z"],
        bounds,
        points,
        values,
    }
}

fn frame(caption: &str, points: &[[f64; 2]], values: &[f64]) -> StripFrame {
    StripFrame {
        caption: caption.into(),
        points: points.to_vec(),
        values: values.to_vec(),
    }
}

/// Colour and place (px) of every dot.
fn dots(svg: &str) -> Vec<(String, f64, f64)> {
    let mut dots = Vec::new();
    for line in svg.lines().filter(|line| line.contains("stroke-linecap")) {
        let quoted: Vec<&str> = line.split('"').collect();
        for place in quoted[1].split("h0").filter(|place| !place.is_empty()) {
            let (x, y) = place[1..].split_once(' ').unwrap();
            dots.push((quoted[5].to_owned(), x.parse().unwrap(), y.parse().unwrap()));
        }
    }
    dots
}

/// Colour and size (px) of every tile, the bars' too.
fn tiles(svg: &str) -> Vec<(String, f64, f64)> {
    let mut tiles = Vec::new();
    for line in svg.lines().filter(|line| line.contains("crispEdges")) {
        let quoted: Vec<&str> = line.split('"').collect();
        for tile in quoted[1].split('z').filter(|tile| !tile.is_empty()) {
            let sizes: Vec<&str> = tile.split(['h', 'v']).collect();
            tiles.push((
                quoted[3].to_owned(),
                sizes[1].parse().unwrap(),
                sizes[2].parse().unwrap(),
            ));
        }
    }
    tiles
}

/// n x n particles, evenly spread over the unit square.
fn lattice(n: usize) -> Vec<[f64; 2]> {
    let at = |i: usize| (i as f64 + 0.5) / n as f64;
    (0..n * n).map(|k| [at(k % n), at(k / n)]).collect()
}

#[test]
fn x_is_to_the_right_y_up_and_both_have_one_scale() {
    for bounds in [[[0.0, 0.0], [10.0, 1.0]], UNIT_SQUARE, [[-1.0, 0.0], [1.0, 20.0]]] {
        let points = vec![[0.2, 0.2], [0.7, 0.2], [0.2, 0.7]];
        let svg = draw_maps("t", &[panel(bounds, points, vec![0.0, 0.5, 1.0])]);
        let dots = dots(&svg);
        let (right, up) = (dots[1].1 - dots[0].1, dots[0].2 - dots[2].2);
        assert!(
            right > 5.0 && (right - up).abs() < 0.31,
            "{bounds:?}: {right} {up}"
        );
        assert!((dots[1].2 - dots[0].2).abs() < 0.11 && (dots[2].1 - dots[0].1).abs() < 0.11);
        assert_eq!((dots[0].0.as_str(), dots[2].0.as_str()), (LOWEST, HIGHEST));
    }
}

#[test]
fn many_particles_are_means_over_tiles_without_holes() {
    let mut points = lattice(300);
    points.extend(lattice(300));
    let half = points.len() / 2;
    // Two particles at each place with opposite values, those of the first row the largest.
    let value = |k: usize| {
        let size = if k % half < 300 { 1.0 } else { 0.2 };
        if k < half { size } else { -size }
    };
    let values = (0..points.len()).map(value).collect();
    let svg = draw_maps("t", &[panel(UNIT_SQUARE, points, values)]);
    check(&svg);
    assert!(dots(&svg).is_empty() && svg.len() < 200_000, "{}", svg.len());
    let all = tiles(&svg);
    let (map, bar) = all.split_at(all.len() - BAR);
    let area: f64 = map.iter().map(|(_, w, h)| w * h).sum();
    assert!((area / (460.0 * 460.0) - 1.0).abs() < 2e-3, "{area}");
    // Every mean is zero: the colour in the middle.
    let middle: Vec<&str> = bar[31..33].iter().map(|tile| tile.0.as_str()).collect();
    assert!(
        map.iter().all(|tile| middle.contains(&tile.0.as_str())),
        "{middle:?} {:?}",
        map[0]
    );
    // Joined tiles are wide, but no tile is high.
    assert!(map.iter().all(|(_, _, h)| *h >= 2.0 && *h < 9.0));
}

#[test]
fn frames_of_a_strip_share_their_colours() {
    let points = [[0.2, 0.5], [0.8, 0.5]];
    let frames = [
        frame("t = 0 s", &points, &[0.0, 1.0]),
        frame("t < 1 s", &points, &[4.0, 2.0]),
    ];
    let svg = draw_strip("slump", &frames, UNIT_SQUARE, "mean stress", "Pa");
    check(&svg);
    let mut dots = dots(&svg);
    dots.sort_by(|a, b| a.1.total_cmp(&b.1));
    assert_eq!((dots[0].0.as_str(), dots[2].0.as_str()), (LOWEST, HIGHEST));
    assert!(dots[1].0 != HIGHEST && dots[3].0 != LOWEST);
    assert_eq!(tiles(&svg).len(), BAR);
    assert!(svg.contains("slump: mean stress [Pa]") && svg.contains("t &lt; 1 s"));
}

#[test]
fn what_a_map_cannot_show_is_counted_and_does_not_stretch_its_colours() {
    let points = vec![[0.1, 0.1], [0.9, 0.9], [5.0, 0.5], [0.5, f64::NAN], [0.5, 0.5]];
    let values = vec![0.0, 1.0, 1e9, 2.0];
    let svg = draw_maps("a < b & c", &[panel(UNIT_SQUARE, points, values)]);
    assert!(svg.contains("1 outside, 2 not finite"), "{svg}");
    assert!(svg.contains("a &lt; b &amp; c") && svg.contains("stress &lt;x&gt; &amp; y [Pa]"));
    let colours: Vec<String> = dots(&svg).into_iter().map(|dot| dot.0).collect();
    assert_eq!(colours, [LOWEST, HIGHEST]);
}

#[test]
fn every_map_and_strip_draws() {
    let corners = [
        UNIT_SQUARE,
        [[0.0, 0.0], [0.0, 0.0]],
        [[f64::NAN, 0.0], [1.0, f64::INFINITY]],
        [[-1e308, -1e308], [1e308, 1e308]],
        [[0.0, 0.0], [1e-12, 1e12]],
        [[1.0, 1.0], [-1.0, -1.0]],
    ];
    let points: [&[[f64; 2]]; 5] = [
        &[],
        &[[0.5, 0.5]],
        &[[0.5, 0.5], [0.5, 0.5]],
        &[[f64::NAN, 0.0], [f64::INFINITY, 1.0]],
        &[[1e299, -1e299], [1e-320, 0.0], [-1e308, 1e308]],
    ];
    let values: [&[f64]; 4] = [
        &[],
        &[1.0, 1.0, 1.0],
        &[f64::NAN, 1e308, -1e308],
        &[1e299, -1e299, 1e-320],
    ];
    for bounds in corners {
        for points in points {
            for values in values {
                let one = panel(bounds, points.to_vec(), values.to_vec());
                check(&draw_maps("t", &[one.clone(), one.clone(), one]));
                let frames = vec![frame("t = 1 s", points, values); 7];
                check(&draw_strip("t", &frames, bounds, "u", "m"));
            }
        }
    }
    assert!(draw_maps("", &[]).contains("no data"));
    assert!(draw_strip("", &[], UNIT_SQUARE, "", "").contains("no data"));
}

#[test]
fn a_million_particles_make_a_small_map() {
    let points = lattice(1000);
    let values = points.iter().map(|[x, y]| x * y).collect();
    let svg = draw_maps("t", &[panel(UNIT_SQUARE, points, values)]);
    assert!(svg.len() < 2_000_000, "{}", svg.len());
}
