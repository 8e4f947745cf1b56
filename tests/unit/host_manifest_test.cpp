#include "host/manifest.hpp"

#include <elf.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <set>

#include "host_fixtures.hpp"

using namespace pelorus::host;
using namespace pelorus::host::test;
using Catch::Matchers::Contains;

namespace {

/// Replaces the only occurrence of `from` by as many bytes.
std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
    const std::size_t at = bytes.find(from);
    REQUIRE(at != std::string::npos);
    REQUIRE(from.size() == to.size());
    return bytes.replace(at, to.size(), to);
}

template <class Field> std::string with_header(std::string bytes, Field Elf64_Ehdr::*field, Field value) {
    Elf64_Ehdr header;
    std::memcpy(&header, bytes.data(), sizeof header);
    header.*field = value;
    std::memcpy(bytes.data(), &header, sizeof header);
    return bytes;
}

}  // namespace

TEST_CASE("A manifest is read from the file alone", "[host]") {
    const Manifests manifests = read_manifests(fixture("good"));
    CHECK(manifests.problem.empty());
    REQUIRE(manifests.plugins.size() == 1);
    const PluginFile& plugin = manifests.plugins.front();
    CHECK(plugin.id == "motion.good");
    CHECK(plugin.kind == "motion");
    CHECK(plugin.table_id == PLR_MOTION);
    CHECK(plugin.version == "1.0.0");
    CHECK(plugin.abi_major == PLR_ABI_MAJOR);
    CHECK(plugin.abi_minor == PLR_ABI_MINOR);
    CHECK(plugin.library == fixture("good"));
}

TEST_CASE("A library of two plugins has two manifests", "[host]") {
    const Manifests manifests = read_manifests(fixture("pair"));
    CHECK(manifests.problem.empty());
    REQUIRE(manifests.plugins.size() == 2);
    const std::set<std::string> ids = {manifests.plugins[0].id, manifests.plugins[1].id};
    CHECK(ids == std::set<std::string>{"motion.pair", "motion.pair_second"});
}

TEST_CASE("Files that are no plugins are told apart", "[host]") {
    const TemporaryFolder folder;
    CHECK(read_manifests(fixture("no_manifest")).problem == "not a Pelorus plugin (no manifest section)");
    CHECK(read_manifests(folder.write("empty.so", "")).problem == "not a shared library (no ELF file)");
    CHECK(read_manifests(folder.write("script.so", "GROUP ( /lib/libm.so.6 )")).problem ==
          "not a shared library (no ELF file)");
    CHECK(read_manifests(folder.path() / "missing.so").problem == "cannot be opened for reading");
    const std::string good = bytes_of(fixture("good"));
    CHECK_THAT(
        read_manifests(folder.write("m.so", with_header(good, &Elf64_Ehdr::e_machine, Elf64_Half{EM_ARM}))).problem,
        Contains("another machine"));
    CHECK_THAT(read_manifests(folder.write("t.so", with_header(good, &Elf64_Ehdr::e_type, Elf64_Half{ET_REL}))).problem,
               Contains("not a shared library"));
    std::string narrow = good;
    narrow[EI_CLASS] = ELFCLASS32;
    CHECK_THAT(read_manifests(folder.write("n.so", narrow)).problem, Contains("64-bit"));
}

TEST_CASE("Broken section headers are refused, absent ones are no manifest", "[host]") {
    const TemporaryFolder folder;
    const std::string good = bytes_of(fixture("good"));
    const auto problem_with = [&](auto field, auto value) {
        return read_manifests(folder.write("x.so", with_header(good, field, value))).problem;
    };
    CHECK_THAT(problem_with(&Elf64_Ehdr::e_shoff, Elf64_Off{0}), Contains("no manifest section"));
    CHECK_THAT(problem_with(&Elf64_Ehdr::e_shoff, ~Elf64_Off{0}), Contains("beyond its end"));
    CHECK_THAT(problem_with(&Elf64_Ehdr::e_shoff, Elf64_Off{good.size() - 10}), Contains("beyond its end"));
    CHECK_THAT(problem_with(&Elf64_Ehdr::e_shnum, Elf64_Half{0xFE00}), Contains("beyond its end"));
    CHECK_THAT(problem_with(&Elf64_Ehdr::e_shentsize, Elf64_Half{1}), Contains("unknown size"));
    CHECK_THAT(problem_with(&Elf64_Ehdr::e_shstrndx, Elf64_Half{0xFE00}), Contains("section names"));
}

TEST_CASE("A manifest that lies about itself is refused", "[host]") {
    const TemporaryFolder folder;
    const std::string good = bytes_of(fixture("good"));
    const auto problem_of = [&](const std::string& bytes) {
        return read_manifests(folder.write("x.so", bytes)).problem;
    };
    std::string head(PLR_MANIFEST_MAGIC, 8);
    const std::uint32_t size = sizeof(plr_manifest);
    head.append(reinterpret_cast<const char*>(&size), sizeof size);

    CHECK_THAT(problem_of(replaced(good, head, "PELOROS" + head.substr(7))), Contains("does not begin with PELORUS"));
    for (const std::uint32_t lie : {0u, 1u, 255u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
        std::string lying = head;
        std::memcpy(lying.data() + 8, &lie, sizeof lie);
        CHECK_THAT(problem_of(replaced(good, head, lying)), Contains("claims " + std::to_string(lie) + " bytes"));
    }
    const std::size_t at = good.find(head);
    std::string unterminated = good;
    unterminated.replace(at + offsetof(plr_manifest, kind), sizeof plr_manifest::kind,
                         std::string(sizeof plr_manifest::kind, 'k'));
    CHECK_THAT(problem_of(unterminated), Contains("kind is empty or not terminated"));
    std::string colourful = good;
    colourful[at + offsetof(plr_manifest, id) + 2] = '\x1b';
    CHECK_THAT(problem_of(colourful), Contains("id holds blanks or characters beyond ASCII"));
    std::string nameless = good;
    nameless[at + offsetof(plr_manifest, version)] = '\0';
    CHECK_THAT(problem_of(nameless), Contains("version is empty"));
    const std::string pair = bytes_of(fixture("pair"));
    const std::size_t first = pair.find(head);
    std::string twice = pair;
    const std::size_t second = pair.find(head, first + 1);
    REQUIRE(second != std::string::npos);
    twice.replace(second, sizeof(plr_manifest), pair.substr(first, sizeof(plr_manifest)));
    CHECK_THAT(problem_of(twice), Contains("two plugins of this library are called"));
}

TEST_CASE("A later, longer manifest is read by its own size", "[host]") {
    // The pair's two manifests lie back to back: one of twice the size covers both.
    const TemporaryFolder folder;
    std::string bytes = bytes_of(fixture("pair"));
    const std::size_t at = bytes.find(std::string(PLR_MANIFEST_MAGIC, 8));
    const std::uint32_t size = 2 * sizeof(plr_manifest);
    std::memcpy(bytes.data() + at + offsetof(plr_manifest, struct_size), &size, sizeof size);
    const Manifests manifests = read_manifests(folder.write("x.so", bytes));
    CHECK(manifests.problem.empty());
    CHECK(manifests.plugins.size() == 1);
}

TEST_CASE("Truncated at any length, a library is refused in one line", "[host]") {
    const TemporaryFolder folder;
    const std::string good = bytes_of(fixture("good"));
    for (std::size_t length = 0; length < good.size(); length += length < 512 ? 1 : 97) {
        const Manifests manifests = read_manifests(folder.write("cut.so", good.substr(0, length)));
        REQUIRE(manifests.plugins.empty());
        REQUIRE(!manifests.problem.empty());
        REQUIRE(manifests.problem.find('\n') == std::string::npos);
    }
}

TEST_CASE("Whatever bytes are damaged, reading ends with manifests or one problem", "[host]") {
    const TemporaryFolder folder;
    const std::string good = bytes_of(fixture("good"));
    Elf64_Ehdr header;
    std::memcpy(&header, good.data(), sizeof header);
    std::mt19937 random(7);
    const auto below = [&random](std::size_t bound) { return static_cast<std::size_t>(random()) % bound; };
    for (int trial = 0; trial < 3000; ++trial) {
        std::string bytes = good;
        for (std::size_t damages = 1 + below(4); damages > 0; --damages) {
            // Where it hurts: the header, the section headers, anywhere.
            const std::size_t places[] = {
                below(sizeof header), header.e_shoff + below(header.e_shnum * sizeof(Elf64_Shdr)), below(bytes.size())};
            bytes[places[below(3)]] = static_cast<char>(below(2) == 0 ? 0xFF : below(256));
        }
        const Manifests manifests = read_manifests(folder.write("damaged.so", bytes));
        REQUIRE(manifests.plugins.empty() != manifests.problem.empty());
    }
}
