#include "elf.hpp"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include "host.hpp"

namespace pelorus::conformance {

namespace {

class ElfFile {
public:
    explicit ElfFile(const std::string& path) : path_(path) {
        std::ifstream stream(path, std::ios::binary);
        bytes_.assign(std::istreambuf_iterator<char>(stream), {});
        header_ = at<Elf64_Ehdr>(0);
        if (std::memcmp(header_.e_ident, ELFMAG, SELFMAG) != 0 || header_.e_ident[EI_CLASS] != ELFCLASS64)
            throw Refused(path + ": is no 64-bit ELF file");
    }

    const Elf64_Ehdr& header() const noexcept { return header_; }
    template <class Struct> Struct at(std::uint64_t offset) const {
        Struct found;
        if (offset > bytes_.size() || bytes_.size() - offset < sizeof found)
            throw Refused(path_ + ": is no ELF file, or lies beyond its own end");
        std::memcpy(&found, bytes_.data() + offset, sizeof found);
        return found;
    }
    Elf64_Shdr section(std::uint64_t index) const {
        return at<Elf64_Shdr>(header_.e_shoff + index * sizeof(Elf64_Shdr));
    }
    /// The entries of a section.
    template <class Entry> std::vector<Entry> entries(const Elf64_Shdr& section) const {
        std::vector<Entry> all;
        for (std::uint64_t i = 0; i < section.sh_size / sizeof(Entry); ++i)
            all.push_back(at<Entry>(section.sh_offset + i * sizeof(Entry)));
        return all;
    }
    std::string text(const Elf64_Shdr& strings, std::uint64_t offset) const {
        const std::uint64_t first = strings.sh_offset + offset;
        if (first >= bytes_.size()) throw Refused(path_ + ": has a name beyond its end");
        const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(first);
        return {begin, std::find(begin, bytes_.end(), '\0')};
    }

private:
    std::string path_;
    std::vector<char> bytes_;
    Elf64_Ehdr header_{};
};

/// Linkers of other times put marks of their own into every library.
bool is_of_the_linker(const std::string& name) {
    static const char* const names[] = {"_init", "_fini", "_edata", "_end", "__bss_start"};
    return std::any_of(std::begin(names), std::end(names), [&](const char* each) { return name == each; });
}

void read_symbols(const ElfFile& file, const Elf64_Shdr& section, ElfFacts& facts) {
    const Elf64_Shdr strings = file.section(section.sh_link);
    for (const auto& symbol : file.entries<Elf64_Sym>(section)) {
        const unsigned char binding = ELF64_ST_BIND(symbol.st_info);
        const std::string name = file.text(strings, symbol.st_name);
        if (name.empty() || binding == STB_LOCAL) continue;
        if (symbol.st_shndx == SHN_UNDEF) {
            if (binding != STB_WEAK) facts.needed.push_back(name);
        } else if (symbol.st_shndx != SHN_ABS && !is_of_the_linker(name)) {  // absolute: the name of a version
            const unsigned char visibility = ELF64_ST_VISIBILITY(symbol.st_other);
            if (visibility == STV_DEFAULT || visibility == STV_PROTECTED) facts.exported.push_back(name);
        }
    }
}

void read_dynamic(const ElfFile& file, const Elf64_Shdr& section, ElfFacts& facts) {
    const Elf64_Shdr strings = file.section(section.sh_link);
    for (const auto& entry : file.entries<Elf64_Dyn>(section)) {
        if (entry.d_tag == DT_NULL) break;
        if (entry.d_tag != DT_RPATH && entry.d_tag != DT_RUNPATH) continue;
        const std::string folders = file.text(strings, entry.d_un.d_val);
        for (std::size_t from = 0; from <= folders.size();) {
            const std::size_t end = std::min(folders.find(':', from), folders.size());
            facts.search_path.push_back(folders.substr(from, end - from));
            from = end + 1;
        }
    }
}

}  // namespace

ElfFacts read_elf(const std::string& path) {
    const ElfFile file(path);
    ElfFacts facts;
    facts.has_executable_stack = true;  // what the loader takes for granted where nothing is said
    for (std::uint64_t i = 0; i < file.header().e_phnum; ++i) {
        const auto segment = file.at<Elf64_Phdr>(file.header().e_phoff + i * sizeof(Elf64_Phdr));
        if (segment.p_type == PT_GNU_STACK) facts.has_executable_stack = (segment.p_flags & PF_X) != 0;
    }
    for (std::uint64_t i = 0; i < file.header().e_shnum; ++i) {
        const Elf64_Shdr section = file.section(i);
        if (section.sh_type == SHT_DYNSYM) read_symbols(file, section, facts);
        if (section.sh_type == SHT_DYNAMIC) read_dynamic(file, section, facts);
    }
    return facts;
}

}  // namespace pelorus::conformance
