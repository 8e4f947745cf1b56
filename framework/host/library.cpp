// Boost.DLL without Boost.Filesystem's compiled part.
#define BOOST_DLL_USE_STD_FS
#include "host/library.hpp"

#include <sodium.h>

#include <array>
#include <boost/dll/shared_library.hpp>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "host/breadcrumb.hpp"
#include "host/error.hpp"
#include "host/plugin_error.hpp"
#include "host/services.hpp"

namespace pelorus::host {

namespace {

[[noreturn]] void refuse(const std::string& reason) { throw Error(Exit::misuse, reason); }

struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

/// "" if the file cannot be read.
std::string sha256_of(std::FILE& file) {
    crypto_hash_sha256_state state;
    crypto_hash_sha256_init(&state);
    std::vector<unsigned char> buffer(1u << 16);
    std::rewind(&file);
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), &file))
        crypto_hash_sha256_update(&state, buffer.data(), got);
    if (std::ferror(&file) != 0) return {};
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash;
    crypto_hash_sha256_final(&state, hash.data());
    std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text;
    sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
    return text.data();
}

/// A library of this process, and what must live as long as it does.
struct Resident {
    Library library;
    File file;  // open as long as the process lives: still the one that was loaded when its name is given to another
    std::string sha256;  // "": not asked for yet
    boost::dll::shared_library handle;
    std::unique_ptr<InstanceHost> host;  // what init was given
    std::string refusal;                 // why it is not usable although it is loaded, or ""
};

/// All of them. Never destroyed: plugins may be called until the very end of the process.
struct Residents {
    std::mutex mutex;  // init and factory are [main]: one thread at a time in the whole process
    std::map<std::filesystem::path, std::unique_ptr<Resident>> by_path;
    std::vector<const Resident*> started;

    static Residents& get() {
        static Residents* const residents = new Residents;
        return *residents;
    }
};

/// dlerror's text out of Boost.DLL's message: `...load() failed (dlerror system message: TEXT): Bad file descriptor [...]`.
std::string loader_text(const std::string& message) {
    static const std::string begin_mark = "dlerror system message: ";
    const std::size_t begin = message.find(begin_mark);
    const std::size_t end = message.rfind("): ");
    if (begin == std::string::npos || end == std::string::npos || end < begin + begin_mark.size()) return message;
    return message.substr(begin + begin_mark.size(), end - begin - begin_mark.size());
}

CallMark mark(const Library& library, const char* call) noexcept {
    CallMark mark{};
    mark.subject = library.path.c_str();
    mark.call = call;
    return mark;
}

void open(Resident& resident) {
    const Breadcrumb crumb(mark(resident.library, "loading"));
    namespace dll = boost::dll;
    try {
        resident.handle.load(resident.library.path, dll::load_mode::rtld_now | dll::load_mode::rtld_local);
    } catch (const std::exception& exception) {
        refuse("the library cannot be loaded: " + one_line(loader_text(exception.what()).c_str(), 4096));
    } catch (...) {
        refuse("the library cannot be loaded: one of its static constructors threw an exception");
    }
}

/// Finds the entry point and checks it; calls nothing.
void check(Resident& resident) {
    if (!resident.handle.has(PLR_ENTRY_SYMBOL)) refuse("the library does not export " PLR_ENTRY_SYMBOL);
    const plr_entry_point& entry = resident.handle.get<const plr_entry_point>(PLR_ENTRY_SYMBOL);
    resident.library.entry = &entry;
    // The manifest said so too, but it is text that a build may have taken from elsewhere.
    if (entry.abi_major != PLR_ABI_MAJOR)
        refuse("its " PLR_ENTRY_SYMBOL " speaks ABI " + std::to_string(entry.abi_major) + ", this host " +
               std::to_string(PLR_ABI_MAJOR) + ": rebuild it with the SDK of this host");
    if (entry.struct_size < sizeof(plr_entry_point))
        refuse("its " PLR_ENTRY_SYMBOL " has " + std::to_string(entry.struct_size) + " bytes, expected at least " +
               std::to_string(sizeof(plr_entry_point)));
    if (entry.factory == nullptr) refuse("its " PLR_ENTRY_SYMBOL " has no factory");
}

/// At exit: ends one library, the one started last. Registered once for each library, right after its init, so that static
/// objects that the library made before or in init are still alive.
void end_last_library() {
    Residents& residents = Residents::get();
    const Resident* last = nullptr;
    {
        const std::lock_guard<std::mutex> lock(residents.mutex);
        if (residents.started.empty()) return;
        last = residents.started.back();
        residents.started.pop_back();
    }
    plr_error error = empty_error();
    const Breadcrumb crumb(mark(last->library, "deinit"));
    const auto deinit = [last] {
        last->library.entry->deinit();
        return PLR_OK;
    };
    if (guarded(error, deinit) != PLR_OK)
        last->host->log()->write(last->host->log()->context, PLR_LOG_ERROR,
                                 ("deinit: " + error_text(error.code, error)).c_str());
}

void start(Resident& resident, Residents& residents) {
    const plr_entry_point& entry = *resident.library.entry;
    resident.host =
        std::make_unique<InstanceHost>(resident.library.path.filename().string(), "", InstanceHost::Shared{});
    if (entry.init != nullptr) {
        plr_error error = empty_error();
        const Breadcrumb crumb(mark(resident.library, "init"));
        const plr_status status = guarded(error, [&] { return entry.init(resident.host->host(), &error); });
        if (status != PLR_OK) refuse("its init failed: " + error_text(status, error));
    }
    if (entry.deinit == nullptr) return;
    residents.started.push_back(&resident);
    if (std::atexit(end_last_library) != 0) {
        residents.started.pop_back();
        refuse("its deinit could not be registered for the end of the process");
    }
}

}  // namespace

const Library& load_library(const std::filesystem::path& path) {
    Residents& residents = Residents::get();
    const std::lock_guard<std::mutex> lock(residents.mutex);
    std::unique_ptr<Resident>& resident = residents.by_path[path];
    if (resident == nullptr) {
        auto loading = std::make_unique<Resident>();
        loading->library.path = path;
        loading->file.reset(std::fopen(path.c_str(), "rbe"));
        if (loading->file == nullptr) refuse("the library cannot be read");
        open(*loading);  // throws: nothing was loaded, a repaired file may be tried again
        resident = std::move(loading);
        try {
            check(*resident);
            start(*resident, residents);
        } catch (const Error& error) {
            resident->refusal = error.what();
        }
    }
    if (!resident->refusal.empty()) refuse(resident->refusal);
    return resident->library;
}

std::string sha256_of(const Library& library) {
    Residents& residents = Residents::get();
    const std::lock_guard<std::mutex> lock(residents.mutex);
    Resident& resident = *residents.by_path.at(library.path);
    if (resident.sha256.empty()) resident.sha256 = sha256_of(*resident.file);
    return resident.sha256;
}

const plr_plugin& make_plugin(const Library& library, const std::string& id) {
    const std::lock_guard<std::mutex> lock(Residents::get().mutex);
    const plr_plugin* plugin = nullptr;
    plr_error error = empty_error();
    const Breadcrumb crumb(mark(library, "factory"));
    const auto factory = [&] {
        plugin = library.entry->factory(id.c_str());
        return PLR_OK;
    };
    const plr_status status = guarded(error, factory);
    if (status != PLR_OK) refuse("its factory failed: " + error_text(status, error));
    if (plugin == nullptr) refuse("its manifest names this id, but its factory does not know it (it answered NULL)");
    return *plugin;
}

}  // namespace pelorus::host
