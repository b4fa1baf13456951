//! Tables and records.

use bekker::measurement::{Record, Table, TableError};
use bekker::signals::{Signals, WheelSignals};

fn text(table: &Table) -> String {
    let mut bytes = Vec::new();
    table.write_csv(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

#[test]
fn property_numbers_read_back_to_the_same_bits() {
    let mut table = Table::new(["time", "x"]).unwrap();
    let values = [0.1 + 0.2, -1.0 / 3.0, 1e-300, 6.02e23, -0.0, f64::MIN_POSITIVE];
    for (k, value) in values.into_iter().enumerate() {
        table.push(&[k as f64, value]).unwrap();
    }
    table.push_with_gaps(&[Some(9.0), None]).unwrap();
    let written = text(&table);
    let mut lines = written.lines();
    assert_eq!(lines.next(), Some("time,x"));
    for value in values {
        let cell = lines.next().unwrap().split(',').nth(1).unwrap().to_owned();
        assert_eq!(cell.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{cell}");
    }
    assert_eq!(lines.next(), Some("9.0,"));
}

#[test]
fn property_a_table_refuses_what_is_no_number() {
    assert_eq!(Table::new(["x", "x"]), Err(TableError::Duplicate("x".to_owned())));
    let mut table = Table::new(["x", "y"]).unwrap();
    assert_eq!(table.push(&[1.0]), Err(TableError::Width { found: 1, expected: 2 }));
    assert_eq!(table.push(&[1.0, f64::NAN]), Err(TableError::NotFinite { column: "y".to_owned(), row: 0 }));
    assert!(table.push_with_gaps(&[Some(f64::INFINITY), None]).is_err());
    assert_eq!(table.rows(), 0, "a refused row leaves nothing behind");
}

#[test]
fn property_a_record_holds_the_chosen_signals_under_their_names() {
    let mut signals = Signals { wheels: vec![WheelSignals::default(); 2], ..Signals::default() };
    signals.body.pitch = 0.25;
    signals.wheels[1].slip = 0.5;
    let names = ["wheel[2].slip".to_owned(), "pitch".to_owned()];
    let mut record = Record::new(&mut signals, Some(&names)).unwrap();
    record.push(0.5, &signals).unwrap();
    assert_eq!(text(record.table()), "time,pitch,wheel[2].slip\n0.5,0.25,0.5\n");
    let all = Record::new(&mut signals, None).unwrap();
    assert_eq!(all.table().names().len(), 1 + bekker::modeldescription::Lookup::list(&mut signals).len());
    let wrong = Record::new(&mut signals, Some(&["wheel[3].slip".to_owned()])).unwrap_err().to_string();
    assert!(wrong.contains("wheel[3].slip") && wrong.contains("did you mean"), "{wrong}");
    signals.body.x = f64::NAN;
    let error = record.push(1.0, &signals);
    assert!(error.is_ok(), "a signal that is not recorded does not matter");
    signals.body.pitch = f64::NAN;
    assert!(record.push(1.5, &signals).is_err());
}
