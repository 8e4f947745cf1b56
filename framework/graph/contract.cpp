#include "graph/contract.hpp"

#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>

#include "graph/units.hpp"
#include "host/description.hpp"
#include "host/first_size.hpp"
#include "host/plugin_error.hpp"
#include "host/scratch.hpp"

namespace pelorus::graph {

namespace {

using host::element;

constexpr std::size_t longest_name = 256;

struct Wrong : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void need(bool good, const std::string& otherwise) {
    if (!good) throw Wrong(otherwise);
}

void need_space(const plr_space* space, const std::string& what, bool has_priors) {
    const std::string problem = space_problem(space, has_priors);
    need(problem.empty(), "info: the " + what + " space " + problem);
}

/// The functions of a table, as far as its struct_size says that they are there.
template <class Table> class Functions {
public:
    explicit Functions(const plr_table_head* head) : table_(*reinterpret_cast<const Table*>(head)) {}

    template <class Function> bool has(Function Table::*function) const {
        const auto offset = static_cast<std::size_t>(reinterpret_cast<const char*>(&(table_.*function)) -
                                                     reinterpret_cast<const char*>(&table_));
        return offset + sizeof(Function) <= table_.head.struct_size && table_.*function != nullptr;
    }
    template <class Function>
    void need(Function Table::*function, const char* name, const std::string& why = {}) const {
        if (!has(function))
            throw Wrong(std::string("its table has no function ") + name + (why.empty() ? "" : ", " + why));
    }
    const Table& table() const { return table_; }

    /// The info struct that the instance answers, whole.
    template <class Info> const Info& info(const Info* (*Table::*function)(const void*), const void* self) const {
        need(function, "info");
        const Info* answer = nullptr;
        plr_error error = host::empty_error();
        const plr_status status = host::guarded(error, [&] {
            answer = (table_.*function)(self);
            return PLR_OK;
        });
        graph::need(status == PLR_OK, "info: " + host::error_text(status, error));
        graph::need(answer != nullptr, "info answered NULL");
        graph::need(answer->struct_size >= host::first_size<Info>,
                    "info: a struct_size of " + std::to_string(answer->struct_size) + " bytes, expected at least " +
                        std::to_string(host::first_size<Info>));
        graph::need(answer->scratch_bytes <= host::most_scratch_of_a_model,
                    "info: scratch_bytes is " + std::to_string(answer->scratch_bytes) + ", expected at most " +
                        std::to_string(host::most_scratch_of_a_model));
        return *answer;
    }

private:
    const Table& table_;
};

void need_record(std::int64_t size) { need(size >= 0, "info: a record_size of " + std::to_string(size)); }

bool same_space(const plr_space& a, const plr_space& b) {
    if (a.size != b.size) return false;
    for (std::uint32_t i = 0; i < a.size; ++i) {
        const plr_component& left = element(a.components, i);
        const plr_component& right = element(b.components, i);
        if (std::string(left.name) != right.name || std::string(left.unit) != right.unit) return false;
    }
    return true;
}

void check_motion(const plr_instance& instance) {
    const Functions<plr_motion> f(instance.table);
    const plr_motion_info& info = f.info(&plr_motion::info, instance.self);
    need_space(info.state, "state", true);
    need_space(info.cartesian, "Cartesian", true);
    need_record(info.record_size);
    f.need(&plr_motion::propagate, "propagate");
    f.need(&plr_motion::jacobian, "jacobian");
    f.need(&plr_motion::noise, "noise");
    if (info.record_size > 0) {
        f.need(&plr_motion::init_record, "init_record", "but a record");
        f.need(&plr_motion::advance_record, "advance_record", "but a record");
    }
    if (!same_space(*info.state, *info.cartesian)) {
        f.need(&plr_motion::to_cartesian, "to_cartesian", "but a state that is not Cartesian");
        f.need(&plr_motion::from_cartesian, "from_cartesian", "but a state that is not Cartesian");
    }
}

void check_sensor(const plr_instance& instance) {
    const Functions<plr_sensor> f(instance.table);
    const plr_sensor_info& info = f.info(&plr_sensor::info, instance.self);
    need_space(info.measurement, "measurement", false);
    need_space(info.cartesian, "Cartesian", false);
    f.need(&plr_sensor::measure, "measure");
    f.need(&plr_sensor::jacobian, "jacobian");
    f.need(&plr_sensor::noise, "noise");
    f.need(&plr_sensor::residual, "residual");
    if ((info.flags & PLR_SENSOR_CAN_INVERT) != 0) {
        f.need(&plr_sensor::invert, "invert", "but the flag PLR_SENSOR_CAN_INVERT");
        need_space(info.inverse, "inverse", false);
    }
    if ((info.flags & PLR_SENSOR_WAVEFORM) != 0) need_space(info.waveform, "waveform", false);
}

void check_estimator(const plr_instance& instance) {
    const Functions<plr_estimator> f(instance.table);
    const plr_estimator_info& info = f.info(&plr_estimator::info, instance.self);
    need_space(info.state, "state", true);
    need_space(info.cartesian, "Cartesian", true);
    need(info.record_size > 0, "info: a record_size of " + std::to_string(info.record_size));
    need(info.sensor_count == 0 || info.sensors != nullptr,
         "info claims " + std::to_string(info.sensor_count) + " sensors but gives none (NULL)");
    f.need(&plr_estimator::init, "init");
    f.need(&plr_estimator::predict, "predict");
    f.need(&plr_estimator::project, "project");
    f.need(&plr_estimator::update, "update");
    f.need(&plr_estimator::summary, "summary");
    f.need(&plr_estimator::moments, "moments");
    if ((info.flags & PLR_ESTIMATOR_ASSIGNABLE) != 0)
        f.need(&plr_estimator::assign, "assign", "but the flag PLR_ESTIMATOR_ASSIGNABLE");
}

void check_joint(const plr_extent_joint& joint) {
    need(joint.struct_size >= sizeof(plr_extent_joint),
         "its extension " PLR_EXTENT_JOINT " has " + std::to_string(joint.struct_size) + " bytes, expected at least " +
             std::to_string(sizeof(plr_extent_joint)));
    need_space(joint.cartesian, "joint Cartesian", true);
    need(joint.init != nullptr && joint.predict != nullptr && joint.update != nullptr && joint.summary != nullptr &&
             joint.gate != nullptr,
         "its extension " PLR_EXTENT_JOINT " lacks a function");
}

void check_extent(const plr_instance& instance) {
    const Functions<plr_extent> f(instance.table);
    const plr_extent_info& info = f.info(&plr_extent::info, instance.self);
    need(info.dimension >= 1 && info.dimension <= 3,
         "info: a dimension of " + std::to_string(info.dimension) + ", expected 1 to 3");
    need(info.start_scans >= 1, "info: start_scans is " + std::to_string(info.start_scans) + ", expected at least 1");
    need(info.record_size > 0, "info: a record_size of " + std::to_string(info.record_size));
    f.need(&plr_extent::shape, "shape");
    const void* joint = nullptr;
    plr_error error = host::empty_error();
    const plr_status status = host::guarded(error, [&] {
        if (instance.table->extension != nullptr) joint = instance.table->extension(instance.self, PLR_EXTENT_JOINT);
        return PLR_OK;
    });
    need(status == PLR_OK, "extension: " + host::error_text(status, error));
    if (joint != nullptr) return check_joint(*static_cast<const plr_extent_joint*>(joint));
    f.need(&plr_extent::init, "init");
    f.need(&plr_extent::predict, "predict");
    f.need(&plr_extent::effective_noise, "effective_noise");
    f.need(&plr_extent::update, "update");
    f.need(&plr_extent::gate, "gate");
}

void check_partitioner(const plr_instance& instance) {
    const Functions<plr_partitioner> f(instance.table);
    const plr_partitioner_info& info = f.info(&plr_partitioner::info, instance.self);
    need(info.dimension_min >= 1 && info.dimension_max >= info.dimension_min, "info: dimensions that no points have");
    f.need(&plr_partitioner::split, "split");
}

void check_waveform(const plr_instance& instance) {
    const Functions<plr_waveform> f(instance.table);
    const plr_waveform_info& info = f.info(&plr_waveform::info, instance.self);
    need_space(info.measurement, "measurement", false);
    need_space(info.waveform, "waveform", false);
    need(info.horizon >= 1, "info: a horizon of " + std::to_string(info.horizon) + ", expected at least 1");
    f.need(&plr_waveform::choose, "choose");
    f.need(&plr_waveform::noise, "noise");
}

void check_trajectory(const plr_instance& instance) {
    const Functions<plr_trajectory> f(instance.table);
    const plr_trajectory_info& info = f.info(&plr_trajectory::info, instance.self);
    need_space(info.state, "state", false);
    need(info.objects >= 1, "info: " + std::to_string(info.objects) + " objects");
    need(info.extent_dimension >= 0 && info.extent_dimension <= 3,
         "info: an extent_dimension of " + std::to_string(info.extent_dimension) + ", expected 0 to 3");
    need_record(info.record_size);
    f.need(&plr_trajectory::realise, "realise");
    f.need(&plr_trajectory::states, "states");
}

void check_stage(const plr_description& description, const plr_instance& instance) {
    const Functions<plr_stage> f(instance.table);
    if (std::string(description.kind) == "source") {
        f.need(&plr_stage::next, "next", "but the kind source");
        f.need(&plr_stage::emit, "emit", "but the kind source");
    }
    if (description.in_port_count > 0) f.need(&plr_stage::receive, "receive", "but in ports");
    f.need(&plr_stage::finish, "finish");
    if (f.has(&plr_stage::save)) f.need(&plr_stage::load, "load", "but save");
}

void check(const std::string& table_id, const plr_description& description, const plr_instance& instance) {
    need(instance.table != nullptr, "create answered PLR_OK but no table (NULL)");
    need(instance.table->struct_size >= sizeof(plr_table_head),
         "its table has " + std::to_string(instance.table->struct_size) + " bytes, expected at least " +
             std::to_string(sizeof(plr_table_head)));
    need(instance.table->destroy != nullptr, "its table has no function destroy");
    if (table_id == PLR_MOTION)
        check_motion(instance);
    else if (table_id == PLR_SENSOR)
        check_sensor(instance);
    else if (table_id == PLR_ESTIMATOR)
        check_estimator(instance);
    else if (table_id == PLR_EXTENT)
        check_extent(instance);
    else if (table_id == PLR_PARTITIONER)
        check_partitioner(instance);
    else if (table_id == PLR_WAVEFORM)
        check_waveform(instance);
    else if (table_id == PLR_TRAJECTORY)
        check_trajectory(instance);
    else if (table_id == PLR_STAGE)
        check_stage(description, instance);
    else
        throw Wrong("its table is a " + table_id + ", which this host does not know");
}

}  // namespace

std::string space_problem(const plr_space* space, bool has_priors) {
    if (space == nullptr) return "is missing (NULL)";
    if (space->struct_size < host::first_size<plr_space>)
        return "has a struct_size of " + std::to_string(space->struct_size);
    if (space->size == 0 || space->components == nullptr) return "has no components";
    if (space->components->struct_size < host::first_size<plr_component>)
        return "has components with a struct_size of " + std::to_string(space->components->struct_size);
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < space->size; ++i) {
        const plr_component& component = element(space->components, i);
        if (component.name == nullptr || *component.name == '\0') return "has a component without a name";
        const std::string name = host::one_line(component.name, longest_name);
        if (!names.insert(name).second) return "has two components " + name;
        if (component.unit == nullptr) return "has a component " + name + " without a unit (NULL)";
        try {
            if (!parse_unit(component.unit).is_si()) throw UnitError("not SI");
        } catch (const UnitError&) {
            return "gives " + name + " in '" + host::one_line(component.unit, longest_name) +
                   "', which is not an SI unit";
        }
        if (has_priors && (!std::isfinite(component.prior_mean) || !std::isfinite(component.prior_deviation) ||
                           component.prior_deviation <= 0))
            return "declares no prior mean and positive deviation for " + name;
    }
    return {};
}

std::string instance_problem(const std::string& table_id, const plr_description& description,
                             const plr_instance& instance) {
    try {
        check(table_id, description, instance);
        return {};
    } catch (const Wrong& wrong) {
        return wrong.what();
    }
}

}  // namespace pelorus::graph
