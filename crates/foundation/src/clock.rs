//! Processor time: what a work costs, whatever else the machine does meanwhile.

/// A clock that counts the processor time of the calling thread and of the threads of its pool. Other programs on the machine do not
/// make it run, as they make the clock on the wall. It still runs more slowly or faster with what the processor shares among threads:
/// caches, the bus, and the units of a core that executes two of them.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: f64,
}

impl Clock {
    /// Starts the threads of the pool, and then the clock.
    pub fn start() -> Clock {
        rayon::broadcast(|_| ());
        Clock { start: used() }
    }

    /// The processor time since the start, s.
    pub fn seconds(&self) -> f64 {
        (used() - self.start).max(0.0)
    }
}

/// The processor time of the calling thread and of those of its pool, s.
fn used() -> f64 {
    match (rayon::current_thread_index(), rayon::current_num_threads()) {
        // One thread need not be asked by another.
        (Some(_), 1) => of_thread(),
        (Some(_), _) => of_pool(),
        (None, _) => of_pool() + of_thread(),
    }
}

fn of_pool() -> f64 {
    rayon::broadcast(|_| of_thread()).into_iter().sum()
}

/// The processor time of this thread, s.
#[cfg(any(unix, windows))]
fn of_thread() -> f64 {
    cpu_time::ThreadTime::try_now().map_or(0.0, |time| time.as_duration().as_secs_f64())
}

/// Where no processor time is known, that of the clock on the wall.
#[cfg(not(any(unix, windows)))]
fn of_thread() -> f64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
