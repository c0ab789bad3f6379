//! One 4 kHz sample without a plan, in process.

use control::{Controller, Settings};

use crate::Failure;
use crate::statistics::{Durations, time};

/// Samples between two plans: 10 s, the longest period.
const SAMPLES: u32 = 40_000;
const BATCH: u32 = 100;

/// Prints the duration of a sample of the T-flex controller, averaged over batches.
pub fn run() -> Result<(), Failure> {
    let mut settings = Settings::tflex();
    settings.nmpc.period = 10.0;
    // So long a prediction cannot follow the fast feedback; a sample does not use it.
    settings.nmpc.models_feedback = false;
    let mut controller = Controller::new(&settings).map_err(|errors| errors[0].to_string())?;
    let mut torque = controller.sample(1.3, 1.3).torque;
    let mut durations = Vec::new();
    for batch in 0..(SAMPLES - 1) / BATCH {
        let angle = 1.3 + 1e-5 * f64::from(batch % 7);
        let (duration, ()) = time(|| {
            for sample in 0..BATCH {
                torque += controller
                    .sample(angle + 1e-7 * f64::from(sample), 1.3)
                    .torque;
            }
        });
        durations.push(duration / BATCH);
    }
    assert!(std::hint::black_box(torque).is_finite());
    println!("\n4 kHz sample without a plan             median        p99        max");
    println!(
        "  in process                      {}",
        Durations::new(durations).row()
    );
    Ok(())
}
