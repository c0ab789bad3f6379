//! Steps and the exchange of values allocate nothing.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use crate::session::{BOTH, Kind, OK, Session, Version};
use crate::toy::*;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: forwards to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count(action: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.with(Cell::get);
    action();
    ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert!(count(|| drop(std::hint::black_box(Box::new(1)))) > 0);
}

#[test]
fn a_sample_allocates_nothing() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        // The events of the toy log; a category that nobody wants costs nothing.
        assert_eq!(s.set_debug_logging(true, &["logStatusError"]), OK);
        s.initialize(0.0, None);
        let allocations = count(|| {
            for k in 0..100 {
                assert_eq!(s.set(U, 0.5), OK);
                assert_eq!(s.set_boolean(HOLD, 0), OK);
                assert_eq!(s.do_step(f64::from(k) * 0.1, 0.1), OK);
                assert!(s.get(X) >= 0.0);
                assert_eq!(s.get_int(SAMPLES), k + 1);
            }
        });
        assert_eq!(allocations, 0);
    }
}

/// Whatever size arrays were given before; saving into a state that exists included.
#[test]
fn arrays_allocate_when_they_are_sized_only() {
    let s = Session::new(Version::Fmi3, Kind::CoSimulation);
    assert_eq!(s.set_debug_logging(true, &["logStatusError"]), OK);
    s.configure(SIZE, 500);
    s.initialize(0.0, None);
    let (mut state, mut ramp) = (std::ptr::null_mut(), vec![0.0; 500]);
    assert_eq!(s.save(&mut state), OK);
    let allocations = count(|| {
        for k in 0..100 {
            assert_eq!(s.set(U, f64::from(k)), OK);
            assert_eq!(s.do_step(f64::from(k) * 0.1, 0.1), OK);
            assert_eq!(s.get_reals(&[RAMP], &mut ramp), OK);
            assert_eq!(s.save(&mut state), OK);
            assert_eq!(s.restore(state), OK);
        }
    });
    assert_eq!((allocations, ramp[499]), (0, 99.0));
    assert_eq!(s.free_state(&mut state), OK);
}

#[test]
fn an_integrator_step_allocates_nothing() {
    for version in BOTH {
        let s = Session::new(version, Kind::ModelExchange);
        assert_eq!(s.set_debug_logging(false, &[]), OK);
        s.initialize(0.0, None);
        s.update_discrete().unwrap();
        assert_eq!(s.enter_continuous_time(), OK);
        let allocations = count(|| {
            let (mut x, mut d) = ([0.0], [0.0]);
            for k in 1..100 {
                let t = f64::from(k) * 0.1;
                assert_eq!(s.set_time(t), OK);
                assert_eq!(s.get_states(&mut x), OK);
                assert_eq!(s.get_derivatives(&mut d), OK);
                assert_eq!(s.set_states(&[x[0] + 0.1 * d[0]]), OK);
                assert_eq!(s.completed_step(), Ok(true));
                assert_eq!(s.enter_event_mode(), OK);
                assert!(s.update_discrete().is_ok());
                assert_eq!(s.enter_continuous_time(), OK);
            }
        });
        assert_eq!(allocations, 0);
    }
}
