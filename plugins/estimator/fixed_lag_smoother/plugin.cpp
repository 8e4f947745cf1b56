#include "fixed_lag_smoother.hpp"

PELORUS_PLUGIN(fixed_lag_smoother::FixedLagSmoother, "estimator.fixed_lag_smoother");
