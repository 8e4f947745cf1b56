/// What becomes of a signal in a child: a fault in guarded memory is a broken promise with a name; any other is a crash.
#pragma once

namespace pelorus::conformance {

/// The handlers write an outcome to the descriptor and end the process.
void install_fault_handler(int descriptor);
/// Of what a handler of signals is handed: the instruction at fault.
const void* instruction_of(void* context) noexcept;
/// Shown with the fault; must stay alive.
void set_subject_of_fault(const char* title) noexcept;
/// The function that is called, where the place alone might not tell it; "": none. Must stay alive.
void set_call_of_fault(const char* function) noexcept;

}  // namespace pelorus::conformance
