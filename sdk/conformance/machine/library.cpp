#include "library.hpp"

#include <dlfcn.h>

#include <map>
#include <memory>

#include <catch2/catch.hpp>

#include "watch.hpp"

namespace pelorus::conformance {

plr_error empty_error() noexcept {
    plr_error error{};
    error.struct_size = sizeof error;
    error.item = -1;
    return error;
}

const char* status_name(plr_status status) noexcept {
    switch (status) {
        case PLR_OK:
            return "PLR_OK";
        case PLR_ITEMS_FAILED:
            return "PLR_ITEMS_FAILED";
        case PLR_E_ARGUMENT:
            return "PLR_E_ARGUMENT";
        case PLR_E_PARAMETER:
            return "PLR_E_PARAMETER";
        case PLR_E_PART:
            return "PLR_E_PART";
        case PLR_E_CAPACITY:
            return "PLR_E_CAPACITY";
        case PLR_E_SCRATCH:
            return "PLR_E_SCRATCH";
        case PLR_E_UNSUPPORTED:
            return "PLR_E_UNSUPPORTED";
        case PLR_E_NUMERIC:
            return "PLR_E_NUMERIC";
        case PLR_E_DATA:
            return "PLR_E_DATA";
        case PLR_E_STATE_VERSION:
            return "PLR_E_STATE_VERSION";
        case PLR_E_IO:
            return "PLR_E_IO";
        case PLR_E_MEMORY:
            return "PLR_E_MEMORY";
        case PLR_E_CANCELLED:
            return "PLR_E_CANCELLED";
        case PLR_E_EXCEPTION:
            return "PLR_E_EXCEPTION";
        default:
            return nullptr;
    }
}

std::string told(plr_status status, const plr_error& error) {
    const char* const name = status_name(status);
    std::string text = name != nullptr ? name : "status " + std::to_string(status) + ", which is none";
    if (error.message[0] != 0)
        text += std::string(": ") + (error.where[0] != 0 ? std::string(error.where) + ": " : "") + error.message;
    if (error.item >= 0) text += " (item " + std::to_string(error.item) + ")";
    return text;
}

std::string exception_text() {
    try {
        throw;
    } catch (const std::exception& exception) {
        return std::string("a std::exception: ") + exception.what();
    } catch (...) {
        return "an exception that is no std::exception";
    }
}

Library::Library(const std::string& path) : path_(path) {
    void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) FAIL("the library cannot be loaded: " << dlerror());
    void* const symbol = dlsym(handle, PLR_ENTRY_SYMBOL);
    if (symbol == nullptr) FAIL("the library exports no " PLR_ENTRY_SYMBOL);
    entry_ = static_cast<const plr_entry_point*>(symbol);
    if (entry_->abi_major != PLR_ABI_MAJOR)
        FAIL("the entry point says ABI " << entry_->abi_major << "." << entry_->abi_minor << ", this suite is of "
                                         << PLR_ABI_MAJOR << "." << PLR_ABI_MINOR);
    if (entry_->factory == nullptr) FAIL("the entry point has no factory");
    set_watched_library(path, reinterpret_cast<const void*>(entry_->factory));
}

const Library& Library::load(const std::string& path) {
    static std::unique_ptr<const Library> loaded;
    if (!loaded) {
        loaded.reset(new Library(path));
        if (loaded->entry_->init != nullptr) {
            static const plr_host host{
                sizeof(plr_host), PLR_ABI_MAJOR, PLR_ABI_MINOR,
                "conformance",    nullptr,       [](const plr_host*, const char*) -> const void* { return nullptr; }};
            plr_error error = empty_error();
            const plr_status status = loaded->entry_->init(&host, &error);
            if (status != PLR_OK) FAIL("init answered " << told(status, error));
        }
    }
    return *loaded;
}

const plr_plugin& Library::plugin(const std::string& id) const {
    const plr_plugin* const found = entry_->factory(id.c_str());
    if (found == nullptr) FAIL("the factory answers NULL for " << id << ", which the manifest promises");
    if (found->description == nullptr || found->create == nullptr || found->table_id == nullptr)
        FAIL("the plugin " << id << " lacks a description, a table id or create");
    return *found;
}

}  // namespace pelorus::conformance
