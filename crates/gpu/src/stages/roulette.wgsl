// Russian roulette: `integrator/roulette.rs`.

// True if roulette may end paths at this bounce.
fn roulette_active() -> bool {
    return has(ROULETTE_FIXED) || (has(ROULETTE_BY_THROUGHPUT) && params.bounce >= 3u);
}

fn survival_probability(greatest: f32) -> f32 {
    if !roulette_active() {
        return 1.0;
    }
    if has(ROULETTE_FIXED) {
        return job.survival;
    }
    return min(max(quotient(greatest, job.threshold), 0.05), 1.0);
}
