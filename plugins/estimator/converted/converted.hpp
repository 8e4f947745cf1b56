/// estimator.converted: a filter that is given positions in the place of what sensors measure. See README.md.
///
/// The record of a track is that of the filter inside, to which all calls go but those that look at a measurement.
#pragma once

#include <vector>

#include <pelorus/batch_model.hpp>

#include "../../common/sensing/conversion.hpp"

namespace converted {

/// What the calls do; Converted below makes a plugin of it.
class Filter {
public:
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;

    sensing::Conversion conversion_ = sensing::Conversion::predicted;

protected:
    void build(const pelorus::Setup& setup);
    plr_estimator_info told() const;
    const pelorus::EstimatorPart& filter() const noexcept { return filter_; }

private:
    /// How the measurements of a sensor get into the filter.
    struct Route {
        pelorus::SensorPart sensor;
        std::int32_t inside = 0;     ///< the filter's sensor
        bool is_converted = false;   ///< else the filter takes them as they are
        pelorus::SensorPart points;  ///< the filter's sensor, of what is converted
        sensing::Converter converter;
        std::vector<int> index;  ///< of what the sensor looks at, in the filter's Cartesian components
    };
    /// What the sensor should see of a block of records. d components are looked at, and as many measured.
    struct Looked {
        plr_view place, spread;   ///< d x 1 x N, d x d x N
        plr_view seen, jacobian;  ///< d x 1 x N, d x d x N: h(place) and its derivative
    };

    Route route_of(const pelorus::SensorPart& sensor, const std::vector<pelorus::SensorPart>& inside) const;
    const Route& route(std::int32_t sensor) const;
    std::int64_t doubles(const Route& by) const;
    Looked look(const plr_call& call, const Route& by, const plr_estimator_project& inside, double* memory) const;
    void slope(const plr_call& call, const Route& by, const plr_const_view& places, const plr_view& out) const;
    void tell_innovation(const plr_call& call, const Route& by, const Looked& looked,
                         const plr_estimator_update& args) const;
    plr_status update_block(const plr_call& call, const Route& by, const plr_estimator_update& args,
                            double* memory) const;

    pelorus::EstimatorPart filter_;
    std::vector<Route> routes_;
    const plr_part* sensors_ = nullptr;
};

/// `assigns`: the moments of the filter inside may be set.
template <bool assigns> class Converted : public Filter, public pelorus::Estimator<Converted<assigns>> {
public:
    static constexpr bool assignable = assigns;

    static void describe(pelorus::Describe<Converted>& plugin);
    void setup(const pelorus::Setup& setup);
    const void* extension(const char* id) const noexcept;

    plr_status init(const plr_call& call, const plr_estimator_init& args) const {
        return filter().call(&plr_estimator::init, call, args);
    }
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        return filter().call(&plr_estimator::predict, call, args);
    }
    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        return Filter::project(call, args);
    }
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        return Filter::update(call, args);
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return filter().call(&plr_estimator::summary, call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return filter().call(&plr_estimator::moments, call, args);
    }
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const {
        return filter().call(&plr_estimator::assign, call, args);
    }
    plr_status mix(const plr_call& call, const plr_estimator_mix_args& args) const {
        return mix_inside_->mix(filter().self(), &call, &args);
    }

private:
    const plr_estimator_mix* mix_inside_ = nullptr;
    const plr_estimator_modes* modes_inside_ = nullptr;
    plr_estimator_modes modes_{};
};

}  // namespace converted
