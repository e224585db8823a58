// Invocations for all rows of a column.

// The row of an invocation, or NO_ROW.
fn row_of(id: u32) -> u32 {
    return select(NO_ROW, id, id < params.count);
}
