//! Elevation maps: the surface between the nodes, what is doubtful in them, files.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::map::{
    CsvGrid, Doubt, ElevationMap, GroundShape, Interpolation, MapError, RangeError, Surface, blurred, generated,
};
use std::path::PathBuf;
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;

/// Rounding in sums of a few products of numbers of order 1.
const ROUNDING: f64 = 1e-12;

/// Central differences over 1e-5 of a cell-sized surface of order 1.
const DIFFERENCES: f64 = 1e-8;

const SHAPE: GroundShape = GroundShape { nodes: 60, cell: 0.04, feature: 0.15, roughness: 0.05, swell: 0.05 };

/// A folder of this test's own, emptied.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    drop(std::fs::remove_dir_all(&folder));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn written(name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder(&name.replace('.', "_")).join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// What reading the file says.
fn refusal(path: &std::path::Path) -> String {
    ElevationMap::read(path, &CsvGrid::default()).unwrap_err().to_string()
}

#[test]
fn analytic_planes_are_met_exactly_by_both_interpolations() {
    let plane = |x: f64, y: f64| 2.0 + 0.3 * x - 0.7 * y;
    let map = ElevationMap::from_formula(9, 7, 0.5, [10.0, -3.0], plane).unwrap();
    for interpolation in [Interpolation::Bilinear, Interpolation::Smooth] {
        let surface = Surface::new(map.clone(), interpolation);
        for (x, y) in [(10.0, -3.0), (14.0, 0.0), (11.37, -1.21), (13.99, -0.01)] {
            let patch = surface.at([x, y]).unwrap();
            assert!((patch.height - plane(x, y)).abs() < ROUNDING, "{interpolation:?} at {x}, {y}");
            assert!((patch.slope_x - 0.3).abs() < ROUNDING && (patch.slope_y + 0.7).abs() < ROUNDING);
        }
        assert_eq!(surface.at([9.999, -2.0]), None);
    }
}

#[test]
fn property_slopes_are_the_derivatives_of_the_heights() {
    let map = generated(&SHAPE, 3).unwrap();
    let step = 1e-5 * map.cell();
    for interpolation in [Interpolation::Bilinear, Interpolation::Smooth] {
        let surface = Surface::new(map.clone(), interpolation);
        for k in 1..200 {
            // Never on a line of the grid.
            let (x, y) = (0.0117 * f64::from(k) % 2.3 + 1.234e-3, 0.0093 * f64::from(k) % 2.3 + 1.234e-3);
            let z = |x, y| surface.height([x, y]).unwrap();
            let patch = surface.at([x, y]).unwrap();
            let slope_x = (z(x + step, y) - z(x - step, y)) / (2.0 * step);
            let slope_y = (z(x, y + step) - z(x, y - step)) / (2.0 * step);
            assert!((patch.slope_x - slope_x).abs() < DIFFERENCES, "{interpolation:?}, {x}, {y}");
            assert!((patch.slope_y - slope_y).abs() < DIFFERENCES, "{interpolation:?}, {x}, {y}");
        }
    }
}

#[test]
fn property_the_smooth_surface_has_no_jump_in_slope_and_no_overshoot_on_grid_lines() {
    let map = generated(&SHAPE, 5).unwrap();
    let surface = Surface::new(map.clone(), Interpolation::Smooth);
    for row in 1..59 {
        for column in 1..59 {
            let [x, y] = map.place(column, row);
            let (before, after) = (surface.at([x - 1e-9, y]).unwrap(), surface.at([x + 1e-9, y]).unwrap());
            assert!((before.slope_x - after.slope_x).abs() < 1e-5, "node {column}, {row}");
            let between = surface.height([x + 0.5 * map.cell(), y]).unwrap();
            let (a, b) = (map.height(column, row), map.height(column + 1, row));
            assert!(between >= a.min(b) - ROUNDING && between <= a.max(b) + ROUNDING, "node {column}, {row}");
        }
    }
}

#[test]
fn property_holes_have_no_height_and_are_named() {
    let mut heights = vec![0.0; 30];
    heights[8] = f64::NAN;
    let map = ElevationMap::new(6, 5, 1.0, [0.0, 0.0], heights).unwrap();
    let surface = Surface::new(map.clone(), Interpolation::Smooth);
    assert_eq!(surface.height([1.5, 1.5]), None);
    assert_eq!(surface.height([3.5, 3.5]), Some(0.0));
    assert_eq!(map.doubts(), [Doubt::Holes { count: 1, nodes: 30, column: 2, row: 1 }]);
    let (filled, count) = map.filled().unwrap();
    assert_eq!((count, filled.doubts()), (1, vec![]));
}

#[test]
fn property_spikes_and_wrong_units_are_named() {
    let shape = GroundShape { roughness: 0.02, swell: 0.0, ..SHAPE };
    let ground = generated(&shape, 1).unwrap();
    assert_eq!(ground.doubts(), []);
    let mut heights = ground.heights().to_vec();
    heights[60 * 20 + 7] += 3.0;
    let spiky = ground.with_heights(heights).unwrap();
    let doubts = spiky.doubts();
    assert!(
        matches!(doubts[..], [Doubt::Spikes { count: 1, column: 7, row: 20, height }] if (height - 3.0).abs() < 0.1)
    );
    let (smooth, count) = spiky.without_spikes(0.5).unwrap();
    assert_eq!((count, smooth.doubts()), (1, vec![]));
    // The same ground in centimetres on a grid in metres.
    let centimetres = ground.with_heights(ground.heights().iter().map(|z| 100.0 * z).collect()).unwrap();
    assert!(centimetres.doubts().iter().any(|doubt| matches!(doubt, Doubt::Units { .. })));
}

#[test]
fn property_what_is_no_map_is_refused() {
    let zeros = vec![0.0; 4];
    assert_eq!(ElevationMap::new(1, 4, 1.0, [0.0; 2], zeros.clone()), Err(MapError::Size { columns: 1, rows: 4 }));
    assert!(matches!(ElevationMap::new(3, 2, 1.0, [0.0; 2], zeros.clone()), Err(MapError::Count { got: 4, .. })));
    assert!(matches!(ElevationMap::new(2, 2, 0.0, [0.0; 2], zeros.clone()), Err(MapError::Cell { .. })));
    assert!(matches!(ElevationMap::new(2, 2, 1.0, [f64::NAN, 0.0], zeros), Err(MapError::Origin { .. })));
    assert_eq!(ElevationMap::new(2, 2, 1.0, [0.0; 2], vec![f64::NAN; 4]), Err(MapError::Empty));
    let infinite = vec![0.0, 0.0, f64::INFINITY, 0.0];
    assert_eq!(ElevationMap::new(2, 2, 1.0, [0.0; 2], infinite), Err(MapError::Infinite { column: 0, row: 1 }));
    let huge = ElevationMap::new(usize::MAX, 2, 1.0, [0.0; 2], Vec::new());
    assert!(matches!(huge, Err(MapError::Size { .. })));
}

#[test]
fn agreement_all_formats_give_the_same_map() {
    // 3 columns, 2 rows; the north-eastern node is a hole.
    let heights = [1.0, 2.0, 3.0, 4.0, 5.0, f64::NAN];
    let expected = ElevationMap::new(3, 2, 2.0, [100.0, 200.0], heights.to_vec()).unwrap();
    let same = |map: ElevationMap, kind: &str| {
        assert_eq!((map.columns(), map.rows(), map.cell(), map.origin()), (3, 2, 2.0, [100.0, 200.0]), "{kind}");
        let equal = map.heights().iter().zip(expected.heights()).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()));
        assert!(equal, "{kind}: {:?}", map.heights());
    };
    let grid = CsvGrid { cell: 2.0, origin: [100.0, 200.0], from_north: false };
    let read = |path: PathBuf| ElevationMap::read(&path, &grid).unwrap();

    let header = "ncols 3\nnrows 2\nxllcorner 99\nyllcorner 199\ncellsize 2\nNODATA_value -9999\n";
    same(read(written("a.asc", format!("{header}4 5 -9999\n1 2 3\n"))), "asc");
    same(read(written("a.csv", "1,2,3\n4,5,\n")), "csv");

    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }\n";
    npy.extend((text.len() as u16).to_le_bytes());
    npy.extend(text.bytes());
    heights.iter().for_each(|z| npy.extend(z.to_le_bytes()));
    same(read(written("a.npy", npy)), "npy");

    let yaml = written(
        "map.yaml",
        "image: map.pgm\nresolution: 2.0\norigin: [99, 199, 0]\nheight_black: 0\nheight_white: 10\nno_data: 0\n",
    );
    std::fs::write(yaml.with_file_name("map.pgm"), b"P5\n# grey\n3 2\n10\n\x04\x05\x00\x01\x02\x03").unwrap();
    same(read(yaml), "pgm");
    same(read(geotiff("a.tif", 1, [4.0, 5.0, -9999.0, 1.0, 2.0, 3.0])), "tiff");
}

/// A GeoTIFF of 3 x 2 cells of 2 m whose north-western corner is at (99, 203); `model` 1 projected, 2 geographic.
fn geotiff(name: &str, model: u16, values: [f32; 6]) -> PathBuf {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut file = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = file.new_image::<Gray32Float>(3, 2).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[2.0_f64, 2.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 99.0, 203.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &[1_u16, 1, 0, 2, 1024, 0, 1, model, 1025, 0, 1, 1][..]).unwrap();
    tags.write_tag(Tag::GdalNodata, "-9999").unwrap();
    image.write_data(&values).unwrap();
    written(name, bytes.into_inner())
}

#[test]
fn property_broken_files_are_refused_with_their_place() {
    let asc = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 x\n";
    assert!(refusal(&written("b.asc", asc)).contains("line 7: `x`; expected a height"));
    assert!(refusal(&written("c.asc", "ncols 2\nnrows 2\ncellsize 1\n1 2 3 4")).contains("no `xllcorner`"));
    assert!(refusal(&written("b.csv", "1,2\n3\n")).contains("line 2: 1 heights; expected 2"));
    assert!(refusal(&written("b.npy", "PK")).contains("expected a file by numpy.save"));
    let occupancy = "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\n";
    assert!(refusal(&written("b.yaml", occupancy)).contains("a map of occupancy has no heights"));
    assert!(refusal(&geotiff("degrees.tif", 2, [0.0; 6])).contains("a grid in degrees"));
    assert!(refusal(&written("b.tif", "II*")).contains("no GeoTIFF"));
    assert!(refusal(&written("map.xyz", "")).contains("expected a map as .asc"));
    assert!(refusal(&PathBuf::from("absent.asc")).contains("`absent.asc`"));
}

#[test]
fn analytic_range_error_grows_with_range_and_the_filter_keeps_the_mean_of_level_and_sloping_ground() {
    let error = RangeError { random: 0.002, systematic: 0.01 };
    assert!((error.deviation(5.0) - 0.1).abs() < ROUNDING); // (3.15): 5 (0.002 5 + 0.01)
    let plane = ElevationMap::from_formula(41, 41, 0.1, [0.0, 0.0], |x, y| 1.0 + 0.2 * x - 0.1 * y).unwrap();
    let seen = blurred(&plane, [2.0, 2.0], &RangeError { random: 0.1, systematic: 0.1 }).unwrap();
    // Away from the rims, where the window is cut.
    let middle = (20, 20);
    assert!((seen.height(middle.0 + 5, middle.1) - plane.height(middle.0 + 5, middle.1)).abs() < ROUNDING);
    // A perfect sensor changes nothing.
    assert_eq!(blurred(&plane, [2.0, 2.0], &RangeError::default()).unwrap(), plane);
}

#[test]
fn property_the_filter_widens_a_rock() {
    let rock = |x: f64, y: f64| if (x - 4.0).hypot(y) < 0.3 { 0.3 } else { 0.0 };
    let map = ElevationMap::from_formula(61, 41, 0.1, [0.0, -2.0], rock).unwrap();
    let seen = blurred(&map, [0.0, 0.0], &RangeError { random: 0.01, systematic: 0.02 }).unwrap();
    let beside = map.nearest([4.0, 0.45]).unwrap();
    assert_eq!(map.height(beside.0, beside.1), 0.0);
    assert!(seen.height(beside.0, beside.1) > 0.01);
    let total = |map: &ElevationMap| map.heights().iter().sum::<f64>();
    assert!((total(&seen) / total(&map) - 1.0).abs() < 0.1, "the rock's volume is kept about");
}

#[test]
fn property_generated_ground_depends_on_its_seed_alone() {
    assert_eq!(generated(&SHAPE, 7).unwrap(), generated(&SHAPE, 7).unwrap());
    assert_ne!(generated(&SHAPE, 7).unwrap(), generated(&SHAPE, 8).unwrap());
}
