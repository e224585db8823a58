// Invocations for the rows in a queue, which the kernels bind.
//
// A queue starts with five words: groups of 64 invocations, 1 and 1, as indirect dispatches read them, the number of
// rows, and of shadow rays the number of those that are caustic samples. The rows follow, in an order that differs from run to run, on which no result depends.

// The row of an invocation, or NO_ROW.
fn row_of(id: u32) -> u32 {
    if id >= queue[3] {
        return NO_ROW;
    }
    return queue[QUEUE_HEAD + id];
}
