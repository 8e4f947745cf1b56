// The description of motion.composite, and its call table.
#include <memory>

#include <pelorus/batch_model.hpp>

#include "composite.hpp"

namespace composite {

void Composite::describe(pelorus::Describe<Composite>& plugin) {
    plugin.title("Motions side by side")
        .purpose(
            "Joins motions over different components to one, such as a turn in the plane and a random walk in height. "
            "The "
            "parts move, and are disturbed, independently of each other.")
        .equation("x = (x1, x2, ...) in canonical order; F = diag(F1, F2, ...), Q = diag(Q1, Q2, ...)")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, "
            "chapter 6 (motions uncoupled across coordinates)");
    plugin
        .slot("motions", "motion", 1, -1,
              "what is joined; their states are Cartesian, and no component may stand in two of them")
        .slot_parameter("axes", &PartValues::axes)
        .choices({{"x", "a part on one axis moves along x"},
                  {"y", "along y"},
                  {"z", "along z"},
                  {"xy", "a part on two axes: its x is x, its y is y"},
                  {"xz", "its y is z"},
                  {"yz", "its x is y, its y is z"},
                  {"xyz", "a part on three axes, as they are"}})
        .doc("which axes of the whole a part's axes x, y, z are, in this order; its own if absent");
}

namespace {

template <auto Member, class Args> plr_status entry(const void* self, const plr_call* call, const Args* args) noexcept {
    return pelorus::detail::forward<Composite, Args, Member>(self, call, args);
}

constexpr plr_motion table(bool has_record) {
    return {
        {sizeof(plr_motion), 0, &pelorus::detail::destroy<Composite>,
         [](const void* self, const char* id) noexcept { return static_cast<const Composite*>(self)->extension(id); }},
        [](const void* self) noexcept { return static_cast<const Composite*>(self)->info(); },
        &entry<&Composite::propagate, plr_motion_propagate>,
        &entry<&Composite::jacobian, plr_motion_jacobian>,
        &entry<&Composite::noise, plr_motion_noise>,
        has_record ? &entry<&Composite::init_record, plr_motion_record> : nullptr,
        has_record ? &entry<&Composite::advance_record, plr_motion_record> : nullptr,
        nullptr,
        nullptr};
}

}  // namespace

plr_instance Composite::create(const pelorus::Setup& setup) {
    static constexpr plr_motion with_record = table(true), without_record = table(false);
    auto self = std::make_unique<Composite>(setup);
    const plr_motion& chosen = self->info()->record_size > 0 ? with_record : without_record;
    return {self.release(), &chosen.head};
}

}  // namespace composite

PELORUS_PLUGIN(composite::Composite, "motion.composite");
