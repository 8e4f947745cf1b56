#include "host/breadcrumb.hpp"

namespace pelorus::host {

__thread const CallMark* innermost_call __attribute__((tls_model("initial-exec"))) = nullptr;

}  // namespace pelorus::host
