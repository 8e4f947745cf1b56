#include "host/manifest.hpp"

#include <elf.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "host/first_size.hpp"

namespace pelorus::host {

namespace {

#if defined(__x86_64__)
constexpr Elf64_Half this_machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr Elf64_Half this_machine = EM_AARCH64;
#else
#error "Pelorus knows ELF on x86-64 and AArch64 only"
#endif

constexpr std::size_t manifest_size = first_size<plr_manifest>;
constexpr std::uint64_t largest_section = 4096 * manifest_size;

/// What is wrong with the file; ends the reading.
struct Malformed : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file from which only bytes that are there can be read. What is read lies close together in two places, the headers and
/// their names: a window on each saves hundreds of system calls a library.
class BoundedFile {
public:
    explicit BoundedFile(const std::filesystem::path& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (descriptor_ < 0) throw Malformed("cannot be opened for reading");
        struct stat status {};
        if (::fstat(descriptor_, &status) == 0) size_ = static_cast<std::uint64_t>(status.st_size);
    }
    ~BoundedFile() { ::close(descriptor_); }
    BoundedFile(const BoundedFile&) = delete;
    BoundedFile& operator=(const BoundedFile&) = delete;

    std::uint64_t size() const noexcept { return size_; }

    void read(std::uint64_t offset, void* out, std::uint64_t bytes, const char* what) {
        if (offset > size_ || bytes > size_ - offset)
            throw Malformed(std::string("ELF file is truncated or malformed: its ") + what + " lies beyond its end");
        if (bytes > window_size) return fetch(offset, out, bytes);
        if (!windows_[recent_].holds(offset, bytes)) {
            recent_ = 1 - recent_;
            if (!windows_[recent_].holds(offset, bytes)) {
                Window& window = windows_[recent_];
                window.bytes.clear();
                std::vector<char> fetched(static_cast<std::size_t>(std::min(window_size, size_ - offset)));
                fetch(offset, fetched.data(), fetched.size());
                window = {offset, std::move(fetched)};
            }
        }
        const Window& window = windows_[recent_];
        std::memcpy(out, window.bytes.data() + (offset - window.offset), static_cast<std::size_t>(bytes));
    }

private:
    static constexpr std::uint64_t window_size = 16384;
    struct Window {
        std::uint64_t offset = 0;
        std::vector<char> bytes;
        bool holds(std::uint64_t first, std::uint64_t count) const noexcept {
            return first >= offset && first - offset <= bytes.size() && count <= bytes.size() - (first - offset);
        }
    };

    void fetch(std::uint64_t offset, void* out, std::uint64_t bytes) const {
        char* at = static_cast<char*>(out);
        while (bytes > 0) {
            const ssize_t got = ::pread(descriptor_, at, static_cast<std::size_t>(bytes), static_cast<off_t>(offset));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) throw Malformed("cannot be read");
            at += got, offset += static_cast<std::uint64_t>(got), bytes -= static_cast<std::uint64_t>(got);
        }
    }

    int descriptor_;
    std::uint64_t size_ = 0;
    std::array<Window, 2> windows_;
    std::size_t recent_ = 0;
};

Elf64_Ehdr read_header(BoundedFile& file) {
    Elf64_Ehdr header;
    unsigned char ident[EI_NIDENT] = {};
    if (file.size() >= EI_NIDENT) file.read(0, ident, sizeof ident, "identification");
    if (std::memcmp(ident, ELFMAG, SELFMAG) != 0) throw Malformed("not a shared library (no ELF file)");
    if (ident[EI_CLASS] != ELFCLASS64 || ident[EI_DATA] != ELFDATA2LSB)
        throw Malformed("not a 64-bit little-endian ELF file: built for another machine");
    file.read(0, &header, sizeof header, "header");
    if (header.e_type != ET_DYN) throw Malformed("not a shared library (ELF file of another type)");
    if (header.e_machine != this_machine)
        throw Malformed("built for another machine (ELF machine " + std::to_string(header.e_machine) +
                        ", this host's is " + std::to_string(this_machine) + ")");
    return header;
}

/// The section headers; of a library without them (stripped to the bone) none.
class Sections {
public:
    Sections(BoundedFile& file, const Elf64_Ehdr& header) : file_(file), offset_(header.e_shoff) {
        if (offset_ == 0) return;
        if (header.e_shentsize != sizeof(Elf64_Shdr))
            throw Malformed("malformed ELF file: section headers of unknown size");
        // Files with very many sections keep the two numbers in the otherwise unused section 0.
        count_ = header.e_shnum != 0 ? header.e_shnum : read(0).sh_size;
        const std::uint64_t names = header.e_shstrndx != SHN_XINDEX ? header.e_shstrndx : read(0).sh_link;
        if (count_ > (file.size() - std::min(offset_, file.size())) / sizeof(Elf64_Shdr))
            throw Malformed("ELF file is truncated or malformed: its section headers lie beyond its end");
        if (names != SHN_UNDEF && names >= count_) throw Malformed("malformed ELF file: no table of section names");
        if (names != SHN_UNDEF) names_ = read(names);
    }

    std::uint64_t count() const noexcept { return count_; }

    Elf64_Shdr read(std::uint64_t index) {
        // index < count <= size / sizeof: no overflow, except for section 0, which is read before the count is known.
        Elf64_Shdr section;
        file_.read(offset_ + index * sizeof section, &section, sizeof section, "section header");
        return section;
    }

    bool is_named(const Elf64_Shdr& section, const char* name) {
        const std::uint64_t bytes = std::strlen(name) + 1;
        if (section.sh_name > names_.sh_size || bytes > names_.sh_size - section.sh_name) return false;
        if (names_.sh_offset > file_.size()) throw Malformed("malformed ELF file: no table of section names");
        std::string found(bytes, '\0');
        file_.read(names_.sh_offset + section.sh_name, found.data(), bytes, "table of section names");
        return std::memcmp(found.data(), name, bytes) == 0;
    }

private:
    BoundedFile& file_;
    std::uint64_t offset_ = 0, count_ = 0;
    Elf64_Shdr names_{};  // of size 0 where there is none
};

/// A field of fixed size: zero-terminated, not empty, and fit to be printed (it is somebody else's text).
template <std::size_t Capacity> std::string text_field(const char (&field)[Capacity], const char* what) {
    const std::size_t size = ::strnlen(field, Capacity);
    if (size == 0 || size == Capacity)
        throw Malformed(std::string("malformed manifest: its ") + what + " is empty or not terminated");
    for (std::size_t i = 0; i < size; ++i)
        if (field[i] <= ' ' || field[i] > '~')
            throw Malformed(std::string("malformed manifest: its ") + what +
                            " holds blanks or characters beyond ASCII");
    return std::string(field, size);
}

/// One manifest at the start of `bytes`; answers the bytes that it takes.
std::size_t read_manifest(const char* bytes, std::size_t available, const std::filesystem::path& library,
                          PluginFile& out) {
    plr_manifest manifest{};
    if (available < manifest_size) throw Malformed("malformed manifest: the section ends within it");
    std::memcpy(&manifest, bytes, manifest_size);
    if (std::memcmp(manifest.magic, PLR_MANIFEST_MAGIC, sizeof manifest.magic) != 0)
        throw Malformed("malformed manifest: it does not begin with " PLR_MANIFEST_MAGIC);
    if (manifest.struct_size < manifest_size || manifest.struct_size > available)
        throw Malformed("malformed manifest: it claims " + std::to_string(manifest.struct_size) + " bytes");
    out.id = text_field(manifest.id, "id");
    out.kind = text_field(manifest.kind, "kind");
    out.table_id = text_field(manifest.table_id, "table id");
    out.version = text_field(manifest.version, "version");
    out.abi_major = manifest.abi_major;
    out.abi_minor = manifest.abi_minor;
    out.library = library;
    return manifest.struct_size;
}

void read_section(BoundedFile& file, const Elf64_Shdr& section, const std::filesystem::path& library,
                  std::vector<PluginFile>& plugins) {
    if (section.sh_type != SHT_PROGBITS || (section.sh_flags & SHF_COMPRESSED) != 0 ||
        section.sh_size > largest_section)
        throw Malformed("malformed manifest section: wrong type or implausible size");
    std::vector<char> bytes(static_cast<std::size_t>(section.sh_size));
    file.read(section.sh_offset, bytes.data(), bytes.size(), "manifest section");
    std::size_t at = 0;
    while (at < bytes.size()) {
        if (bytes[at] == '\0') {  // padding that the linker put between the manifests of two object files
            ++at;
            continue;
        }
        PluginFile plugin;
        at += read_manifest(bytes.data() + at, bytes.size() - at, library, plugin);
        const auto has_same_id = [&](const PluginFile& other) { return other.id == plugin.id; };
        if (std::any_of(plugins.begin(), plugins.end(), has_same_id))
            throw Malformed("malformed manifest: two plugins of this library are called " + plugin.id);
        plugins.push_back(std::move(plugin));
    }
}

}  // namespace

Manifests read_manifests(const std::filesystem::path& library) {
    Manifests result;
    try {
        BoundedFile file(library);
        Sections sections(file, read_header(file));
        for (std::uint64_t i = 1; i < sections.count(); ++i) {
            const Elf64_Shdr section = sections.read(i);
            if (sections.is_named(section, PLR_MANIFEST_SECTION)) read_section(file, section, library, result.plugins);
        }
        if (result.plugins.empty()) result.problem = "not a Pelorus plugin (no manifest section)";
    } catch (const Malformed& malformed) {
        result.plugins.clear();
        result.problem = malformed.what();
    }
    return result;
}

}  // namespace pelorus::host
