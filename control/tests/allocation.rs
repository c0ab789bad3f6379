//! After set-up a sample allocates nothing, but for the general-purpose conic solver.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

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

/// Allocations in samples that solved no conic problem, over 4 s with four setpoints,
/// and the number of plans among them.
fn allocations(settings: &Settings) -> (u64, u32) {
    let mut controller = Controller::new(settings).unwrap();
    let mut angle = 1.1;
    let (mut allocations, mut plans) = (0, 0);
    for sample in 0..16_000 {
        let setpoint = [1.1, 1.3, 1.0, 1.4][sample / 4000];
        let before = ALLOCATIONS.get();
        let command = controller.sample(angle, setpoint);
        let made = ALLOCATIONS.get() - before;
        angle = command.reference.angle;
        let solved = command.new_plan && controller.plan().iterations > 0;
        plans += u32::from(command.new_plan && !solved);
        if !solved {
            allocations += made;
        }
    }
    (allocations, plans)
}

#[test]
fn following_the_profile_allocates_nothing() {
    for settings in [Settings::tflex(), Settings::pendulum()] {
        let settings = Settings {
            reference: ReferenceSource::Profile,
            ..settings
        };
        assert_eq!(allocations(&settings), (0, 0));
    }
}

#[test]
fn plans_in_closed_form_allocate_nothing() {
    for settings in [Settings::tflex(), Settings::pendulum()] {
        let (allocations, plans) = allocations(&settings);
        eprintln!("{plans} of 80 plans in closed form");
        assert_eq!(allocations, 0);
        assert!(plans >= 20, "{plans}");
    }
}
