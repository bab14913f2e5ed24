//! Where there is no standard library, nothing may panic: the handler calls what does not exist.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn cede_a_panic_is_reachable() -> !;
    }
    // SAFETY: it is not there to be called; a program that could call it does not link.
    unsafe { cede_a_panic_is_reachable() }
}
