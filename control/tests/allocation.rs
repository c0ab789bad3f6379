//! After set-up a sample allocates nothing, the plan included, until the general-purpose conic solver is needed.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::time::Instant;

use common::Loop;
use control::nmpc::{self, settings::Method, solver::Clock};
use control::{Controller, ReferenceSource, Settings};

/// The system's allocator, with a count of the allocations of each thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above; the pointer came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What a run did.
struct Run {
    allocations: u64,
    plans: u32,
    /// Plans that took iterations.
    iterated: u32,
}

/// 4 s with four setpoints.
fn run(settings: &Settings) -> Run {
    let mut controller = Controller::new(settings).unwrap();
    let mut angle = 1.1;
    let mut run = Run {
        allocations: 0,
        plans: 0,
        iterated: 0,
    };
    for sample in 0..16_000 {
        let setpoint = [1.1, 1.3, 1.0, 1.4][sample / 4000];
        let before = ALLOCATIONS.get();
        let command = controller.sample(angle, setpoint);
        run.allocations += ALLOCATIONS.get() - before;
        angle = command.reference.angle;
        run.plans += u32::from(command.new_plan);
        run.iterated +=
            u32::from(command.new_plan && controller.plan().expect("at hand").iterations > 0);
    }
    run
}

#[test]
fn following_the_profile_allocates_nothing() {
    for settings in [Settings::tflex(), Settings::pendulum()] {
        let settings = Settings {
            reference: ReferenceSource::Profile,
            ..settings
        };
        let run = run(&settings);
        assert_eq!((run.allocations, run.plans), (0, 0));
    }
}

#[test]
fn plans_allocate_nothing() {
    let mut hot = Settings::pendulum();
    hot.initial_thermal_load = 0.95 * 0.85 * 0.85 * hot.motor.thermal_limit();
    let mut too_hot = Settings::tflex();
    too_hot.initial_thermal_load = 1.2 * 0.85 * 0.85 * too_hot.motor.thermal_limit();
    for solver in [Method::Automatic, Method::Riccati] {
        for (settings, in_closed_form, iterated) in [
            (Settings::tflex(), 80, 0),
            (Settings::pendulum(), 20, 0),
            (hot, 20, 5),
            (too_hot, 0, 80),
        ] {
            let nmpc = nmpc::settings::Settings {
                solver,
                ..settings.nmpc
            };
            let run = run(&Settings { nmpc, ..settings });
            assert_eq!((run.plans, run.allocations), (80, 0), "{solver:?}");
            assert!(run.iterated >= iterated, "{} iterated", run.iterated);
            let others = run.plans - run.iterated;
            assert!(others >= in_closed_form, "{others} in closed form");
        }
    }
}

/// The machine's clock.
struct Since(Instant);

impl Clock for Since {
    fn now(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Every sequence of Table 2 in closed loop, as the paper plans, at the rate of the feedback, and late with a deadline.
#[test]
fn table_2_allocates_nothing() {
    let golden = include_str!("golden/setpoint_tracking_pendulum.json");
    let golden: serde_json::Value = serde_json::from_str(golden).unwrap();
    let mut fast = Settings::pendulum();
    (fast.nmpc.period, fast.nmpc.duration) = (fast.sample_period, 2.0);
    let mut late = Settings::pendulum();
    (late.nmpc.latency, late.nmpc.deadline) = (0.02, 1.0);
    for (settings, runs) in [(Settings::pendulum(), 8), (fast, 1), (late, 2)] {
        let (mut plans, mut iterated) = (0, 0);
        for run in golden["runs"].as_array().unwrap().iter().take(runs) {
            let samples = (run["interval_s"].as_f64().unwrap() / settings.sample_period) as u32;
            let mut closed_loop = Loop::pendulum(&settings);
            closed_loop
                .controller
                .set_clock(Box::new(Since(Instant::now())));
            for setpoint in run["setpoints_rad"].as_array().unwrap() {
                let setpoint = setpoint.as_f64().unwrap();
                for _ in 0..samples {
                    let before = ALLOCATIONS.get();
                    let command = closed_loop.step(setpoint, 0.0);
                    assert_eq!(ALLOCATIONS.get(), before);
                    plans += u32::from(command.new_plan);
                    iterated += u32::from(
                        command.new_plan
                            && closed_loop.controller.plan().expect("at hand").iterations > 0,
                    );
                }
            }
        }
        eprintln!("{plans} plans, {iterated} of them iterated");
        assert!(iterated > 100, "{iterated}");
    }
}
