// The components of all models together.
#include "imm.hpp"

#include <cmath>

namespace imm {

using pelorus::PartError;

namespace {

/// The prior of a component is the mixture of what the models that have it declare, since each of them starts from its own.
void share_prior(const std::vector<pelorus::Space>& spaces, pelorus::Component& component) {
    std::vector<const pelorus::Component*> own;
    for (const pelorus::Space& each : spaces)
        if (const int k = each.index(component.name); k >= 0) own.push_back(&each[k]);
    const auto number = static_cast<double>(own.size());
    double mean = 0, variance = 0;
    for (const auto* each : own) mean += each->prior_mean / number;
    for (const auto* each : own)
        variance += (std::pow(each->prior_deviation, 2) + std::pow(each->prior_mean - mean, 2)) / number;
    component.prior_mean = mean;
    component.prior_deviation = std::sqrt(variance);
}

}  // namespace

JoinedSpace::JoinedSpace(const std::vector<pelorus::Space>& spaces) {
    const auto largest =
        std::max_element(spaces.begin(), spaces.end(),
                         [](const pelorus::Space& a, const pelorus::Space& b) { return a.size() < b.size(); });
    std::vector<pelorus::Component> all = largest->components();
    for (const pelorus::Space& each : spaces) {
        for (const pelorus::Component& component : each.components()) {
            const auto known = std::find_if(all.begin(), all.end(),
                                            [&](const pelorus::Component& k) { return k.name == component.name; });
            if (known == all.end())
                all.push_back(component);
            else if (known->unit != component.unit)
                throw PartError("estimators", "differ in the unit of " + component.name + ": " + known->unit + " and " +
                                                  component.unit);
        }
    }
    if (all.size() > max_state)
        throw PartError("estimators", "have " + std::to_string(all.size()) + " components together, at most " +
                                          std::to_string(max_state) + " fit this filter");
    for (pelorus::Component& component : all) share_prior(spaces, component);
    space = pelorus::Space(all);
    for (const pelorus::Space& each : spaces) {
        Place place;
        for (const pelorus::Component& component : each.components())
            place.index.push_back(space.index(component.name));
        place.is_whole = each.same(space);
        is_shared = is_shared && place.is_whole;
        places.push_back(place);
    }
    prior = {Column<max_state>::Zero(size(), 1), Square<max_state>::Zero(size(), size())};
    for (int k = 0; k < size(); ++k) {
        if (space[k].angle) angles.push_back(k);
        prior.mean(k) = space[k].prior_mean;
        prior.covariance(k, k) = space[k].prior_deviation * space[k].prior_deviation;
    }
}

}  // namespace imm
