#include "joined_space.hpp"

#include <algorithm>
#include <cstring>

namespace composite {

namespace {

using pelorus::Component;
using pelorus::PartError;

constexpr const char* slot = "motions";
constexpr const char* quantities[] = {"position", "velocity", "acceleration", "jerk"};
constexpr int others = 4 * 3;  // the rank of what is no derivative of a position

struct Entry {
    Component component;
    int rank;
    std::size_t member;
    int place;  ///< within the member
};

/// 0, 1, 2 for a name that ends with .x, .y, .z; else -1.
int axis_of(const std::string& name) {
    if (name.size() < 2 || name[name.size() - 2] != '.') return -1;
    const char* const found = std::strchr("xyz", name.back());
    return found == nullptr ? -1 : static_cast<int>(name.back() - 'x');
}

/// How many axes the components of a part are on: 1 + the last one's index.
int axes_of(const pelorus::Space& space) {
    int count = 0;
    for (const Component& component : space.components()) count = std::max(count, 1 + axis_of(component.name));
    return count;
}

int rank_of(const std::string& name) {
    const int axis = axis_of(name);
    if (axis < 0) return others;
    const std::string quantity = name.substr(0, name.size() - 2);
    for (int order = 0; order < 4; ++order)
        if (quantity == quantities[order]) return 3 * order + axis;
    return others;
}

/// The components of one member under their names in the whole.
void add_entries(const Member& member, std::size_t index, std::vector<Entry>& entries) {
    const pelorus::Space space(*member.motion.info().state);
    const int axes = axes_of(space);
    if (!member.axes.empty() && static_cast<int>(member.axes.size()) != axes)
        throw PartError(slot, member.motion.address() + " moves on " + std::to_string(axes) +
                                  " axes, but its parameter axes names " + std::to_string(member.axes.size()) + ": " +
                                  member.axes);
    for (int i = 0; i < space.size(); ++i) {
        Component component = space[i];
        if (const int axis = axis_of(component.name); axis >= 0 && !member.axes.empty())
            component.name.back() = member.axes[static_cast<std::size_t>(axis)];
        const int rank = rank_of(component.name);
        entries.push_back({std::move(component), rank, index, i});
    }
}

void expect_leading_positions(const std::vector<Entry>& sorted) {
    int expected = 0;
    for (const Entry& entry : sorted) {
        if (entry.rank >= 3) break;
        if (entry.rank != expected)
            throw PartError(slot, std::string("no part has position.") + "xyz"[expected] + ", but one has " +
                                      entry.component.name + "; positions begin with x and leave no axis out");
        ++expected;
    }
    if (expected == 0) throw PartError(slot, "no part has position.x");
}

}  // namespace

pelorus::Space join(std::vector<Member>& members) {
    std::vector<Entry> entries;
    for (std::size_t m = 0; m < members.size(); ++m) add_entries(members[m], m, entries);
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.rank < b.rank; });
    std::vector<Component> components;
    for (Member& member : members) member.places.assign(member.motion.info().state->size, 0);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Entry& entry = entries[i];
        for (std::size_t k = 0; k < i; ++k)
            if (entries[k].component.name == entry.component.name)
                throw PartError(slot, members[entries[k].member].motion.address() + " and " +
                                          members[entry.member].motion.address() + " both have " +
                                          entry.component.name + "; give one of them other axes");
        members[entry.member].places[static_cast<std::size_t>(entry.place)] = static_cast<int>(i);
        components.push_back(entry.component);
    }
    expect_leading_positions(entries);
    return pelorus::Space(std::move(components));
}

}  // namespace composite
