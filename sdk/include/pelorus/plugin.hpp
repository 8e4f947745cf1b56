/// From a class to a plugin: creation, and the one line that exports it.
///
///     PELORUS_PLUGIN(Singer, "motion.singer");
///
/// A plugin class derives from one of the kinds (Motion, Sensor, ..., Stage), is default-constructible, has a static
/// `describe(Describe<Class>&)`, and may have `void setup(const Setup&)`, called once its parameters are in its members.
/// A class that chooses among variants (say, by dimension) has instead
///     static const plr_description* description(const char* id);  static plr_instance create(const Setup&);
#pragma once

#include <cstring>
#include <memory>
#include <type_traits>

#include <pelorus/abi/abi.h>
#include <pelorus/describe.hpp>
#include <pelorus/setup.hpp>

namespace pelorus {

namespace detail {

template <class T, class = void> struct has_setup : std::false_type {};
template <class T>
struct has_setup<T, std::void_t<decltype(std::declval<T&>().setup(std::declval<const Setup&>()))>> : std::true_type {};
template <class T, class = void> struct has_create : std::false_type {};
template <class T>
struct has_create<T, std::void_t<decltype(T::create(std::declval<const Setup&>()))>> : std::true_type {};

template <class T> void destroy(void* self) noexcept { delete static_cast<T*>(self); }

template <std::size_t N> constexpr void copy_text(char (&to)[N], const char* from) {
    std::size_t i = 0;
    for (; from[i] != 0; ++i)
        to[i] = from[i];  // a text that is too long fails to compile: constant evaluation out of bounds
    to[i] = 0;
}

}  // namespace detail

/// Makes one instance of T with its own call table.
template <class T> plr_instance instantiate(const Setup& setup) {
    auto self = std::make_unique<T>();
    const auto& description = Describe<T>::of();
    description.bind(*self, setup.raw());
    if constexpr (detail::has_setup<T>::value) self->setup(setup);
    self->complete(setup.raw(), *description.c());
    return {self.release(), &T::table().head};
}

namespace detail {

template <class T> const plr_description* description_of(const char* id) {
    if constexpr (has_create<T>::value)
        return T::description(id);
    else
        return Describe<T>::of(id).c();
}

template <class T> plr_status create(const plr_config* config, plr_instance* out, plr_error* error) noexcept {
    return guarded(error, [&] {
        if (config->struct_size < PLR_CONFIG_LEAST_SIZE)
            throw ArgumentError("config.struct_size is less than PLR_CONFIG_LEAST_SIZE");
        const Setup setup(*config);
        if constexpr (has_create<T>::value)
            *out = T::create(setup);
        else
            *out = instantiate<T>(setup);
    });
}

/// The library's answer to factory(wanted).
template <class T> const plr_plugin* plugin(const char* id, const char* wanted) noexcept {
    if (wanted == nullptr || std::strcmp(id, wanted) != 0) return nullptr;
    try {
        static const plr_plugin answer{sizeof(plr_plugin), 0, description_of<T>(id), T::table_id, &create<T>};
        return &answer;
    } catch (...) {
        return nullptr;
    }
}

template <class T> constexpr plr_manifest manifest(const char* id) {
    plr_manifest m{};
    copy_text(m.magic, PLR_MANIFEST_MAGIC);
    m.struct_size = sizeof(plr_manifest);
    m.abi_major = PLR_ABI_MAJOR;
    m.abi_minor = PLR_ABI_MINOR;
    copy_text(m.id, id);
    copy_text(m.kind, T::kind);
    copy_text(m.table_id, T::table_id);
    copy_text(m.version, T::version);
    return m;
}

}  // namespace detail

/// One class template over the dimension (1 to 3), chosen by its parameter `dimension`: every instance has the table of its
/// own fixed sizes. Model<D> declares `dimension` itself, bound to an int member.
template <template <int> class Model> struct ByDimension {
    static constexpr const char* kind = Model<3>::kind;
    static constexpr const char* table_id = Model<3>::table_id;
    static constexpr const char* version = Model<3>::version;
    static const plr_description* description(const char* id) { return Describe<Model<3>>::of(id).c(); }
    static plr_instance create(const Setup& setup) {
        switch (dimension(setup)) {
            case 1:
                return instantiate<Model<1>>(setup);
            case 2:
                return instantiate<Model<2>>(setup);
            case 3:
                return instantiate<Model<3>>(setup);
            default:
                throw ParameterError("dimension", "is not 1, 2 or 3");
        }
    }

private:
    static std::int64_t dimension(const Setup& setup) {
        const plr_description& description = *Describe<Model<3>>::of().c();
        for (std::uint32_t i = 0; i < description.parameter_count; ++i)
            if (std::strcmp(description.parameters[i].name, "dimension") == 0) {
                const auto* at = reinterpret_cast<const char*>(setup.raw().values);
                return reinterpret_cast<const plr_value*>(at + i * setup.raw().values->struct_size)->integer;
            }
        throw ParameterError("dimension", "is not described by this plugin");
    }
};

}  // namespace pelorus

/// Exports Class as the library's plugin. Once a library, at file scope, outside all namespaces.
#define PELORUS_PLUGIN(Class, id_)                                                                              \
    __attribute__((section(PLR_MANIFEST_SECTION), used)) static constexpr plr_manifest pelorus_manifest =       \
        ::pelorus::detail::manifest<Class>(id_);                                                                \
    extern "C" {                                                                                                \
    static const plr_plugin* pelorus_factory(const char* wanted) {                                              \
        return ::pelorus::detail::plugin<Class>(id_, wanted);                                                   \
    }                                                                                                           \
    extern PLR_EXPORT const plr_entry_point plr_entry;                                                          \
    const plr_entry_point plr_entry = {sizeof(plr_entry_point), PLR_ABI_MAJOR, PLR_ABI_MINOR, nullptr, nullptr, \
                                       &pelorus_factory};                                                       \
    }                                                                                                           \
    static_assert(sizeof(pelorus_manifest) == sizeof(plr_manifest), "one PELORUS_PLUGIN a library")
