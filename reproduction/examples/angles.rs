//! Development: errors of the contact angles per seed.
use bekker_reproduction::contact_angles::{Wave, incline, rock};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (what, count) = (args[1].as_str(), args[2].parse::<u64>().unwrap());
    let start: u64 = args.get(3).map_or(1000, |s| s.parse().unwrap());
    if what == "wave" {
        for (name, wave) in [
            ("1 Hz", Wave { period: 1.0, ..Wave::default() }),
            ("10 Hz", Wave::default()),
            ("50 Hz", Wave { period: 0.02, ..Wave::default() }),
            ("100 Hz", Wave { period: 0.01, ..Wave::default() }),
        ] {
            let mut sums = [0.0; 4];
            for seed in start..start + count {
                let t = wave.trial(seed);
                for (s, v) in sums.iter_mut().zip([
                    t.ground.errors[1].to_degrees(),
                    t.ground.errors[0].to_degrees(),
                    t.ground.nees,
                    t.ground.nis,
                ]) {
                    *s += v / count as f64;
                }
            }
            println!("{name}: front {:.3} rear {:.3} nees {:.3} nis {:.3}", sums[0], sums[1], sums[2], sums[3]);
        }
    } else {
        let finding = if what == "incline" { incline(count as u32) } else { rock(count as u32) }.unwrap();
        for row in finding.rows {
            println!(
                "{}: {:.3} ({:.3} .. {:.3}) {}",
                row.quantity, row.ours.median, row.ours.low, row.ours.high, row.reason
            );
        }
    }
}
