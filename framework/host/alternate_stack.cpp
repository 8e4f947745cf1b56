#include "host/alternate_stack.hpp"

#include <csignal>
#include <new>

namespace pelorus::host {

namespace {

constexpr std::size_t size = std::size_t{64} << 10;  // SIGSTKSZ is no constant any more, and vector registers are large

}  // namespace

AlternateStack::AlternateStack() noexcept {
    stack_t present{};
    if (::sigaltstack(nullptr, &present) != 0 || (present.ss_flags & SS_DISABLE) == 0) return;
    memory_.reset(new (std::nothrow) unsigned char[size]);
    if (memory_ == nullptr) return;
    stack_t own{};
    own.ss_sp = memory_.get();
    own.ss_size = size;
    if (::sigaltstack(&own, nullptr) != 0) memory_.reset();
}

AlternateStack::~AlternateStack() {
    if (memory_ == nullptr) return;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    ::sigaltstack(&none, nullptr);
}

}  // namespace pelorus::host
