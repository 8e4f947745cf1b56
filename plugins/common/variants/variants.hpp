/// A plugin that chooses among classes by its parameters, which all of them share.
///
///     struct Turn : variants::Variants<Model<3>> {
///         static plr_instance create(const pelorus::Setup& setup) {
///             return parameters(setup).dimension == 2 ? pelorus::instantiate<Model<2>>(setup) : ...;
///         }
///     };
#pragma once

#include <pelorus/plugin.hpp>

namespace variants {

/// `Default` is the class whose description stands for all.
template <class Default> struct Variants {
    static constexpr const char* kind = Default::kind;
    static constexpr const char* table_id = Default::table_id;
    static constexpr const char* version = Default::version;
    static const plr_description* description(const char* id) { return pelorus::Describe<Default>::of(id).c(); }

    /// An object that has its parameters and nothing else yet.
    static Default parameters(const pelorus::Setup& setup) {
        Default chosen;
        pelorus::Describe<Default>::of().bind(chosen, setup.raw());
        return chosen;
    }
};

}  // namespace variants
