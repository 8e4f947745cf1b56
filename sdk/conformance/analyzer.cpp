// What analyzers promise of their results.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

using Tables = std::map<std::string, std::shared_ptr<const plr_message>>;

/// The last table of each name.
Tables tables_of(const StagePlayer& player) {
    Tables tables;
    for (const PublishedMessage& published : player.published())
        if (published.message->kind == PLR_MESSAGE_TABLE)
            tables[published.message->body.table->name] = published.message;
    return tables;
}

Tables results(const Bench& bench, const FeedOptions& options = {}) {
    const Script script = plain_script(bench, options);
    StagePlayer player(bench);
    play(player, script);
    player.finish_well();
    return tables_of(player);
}

/// Names of columns and scalars with units and reductions: what has to be the same in all runs of a campaign.
std::vector<std::string> layout_of(const plr_table& table) {
    std::vector<std::string> words;
    for (std::uint32_t c = 0; c < table.column_count; ++c) {
        const plr_column& column = element_of(table.columns, c);
        words.push_back(std::string("column ") + column.name + " [" + column.unit + "] reduced by " +
                        std::to_string(column.reduce));
    }
    for (std::uint32_t s = 0; s < table.scalar_count; ++s) {
        const plr_scalar& scalar = element_of(table.scalars, s);
        words.push_back(std::string("scalar ") + scalar.name + " [" + scalar.unit + "]");
    }
    return words;
}

/// The first word that is not among the others, or "".
std::string missing_in(const std::vector<std::string>& words, const std::vector<std::string>& others) {
    for (const std::string& word : words)
        if (std::find(others.begin(), others.end(), word) == others.end()) return word;
    return {};
}

double number_at(const plr_table& table, std::int64_t row, std::uint32_t column) {
    return table.rows.data[row * table.rows.item_stride + column * table.rows.row_stride];
}

std::string table_name(const std::string& name) { return name.empty() ? "the scalars" : "table `" + name + "`"; }

/// Equal to rounding: sums may be formed in another order.
bool is_close(double one, double other) {
    if (std::isnan(one) || std::isnan(other)) return std::isnan(one) == std::isnan(other);
    return std::abs(one - other) <= 1e-9 * std::max({1.0, std::abs(one), std::abs(other)});
}

std::string difference_of(const plr_table& one, const plr_table& other) {
    if (one.rows.count != other.rows.count)
        return std::to_string(one.rows.count) + " rows against " + std::to_string(other.rows.count);
    for (std::int64_t row = 0; row < one.rows.count; ++row)
        for (std::uint32_t c = 0; c < one.column_count; ++c)
            if (!is_close(number_at(one, row, c), number_at(other, row, c)))
                return std::string("column ") + element_of(one.columns, c).name + " of row " + std::to_string(row) +
                       ": " + std::to_string(number_at(one, row, c)) + " against " +
                       std::to_string(number_at(other, row, c));
    for (std::uint32_t s = 0; s < std::min(one.scalar_count, other.scalar_count); ++s) {
        const plr_scalar &mine = element_of(one.scalars, s), &theirs = element_of(other.scalars, s);
        if (mine.column == nullptr && !is_close(mine.value, theirs.value))
            return std::string("scalar ") + mine.name + ": " + std::to_string(mine.value) + " against " +
                   std::to_string(theirs.value);
    }
    return {};
}

}  // namespace

PELORUS_CHECK(analyzer, "analyzer-tells-its-results", 3,
              "An analyzer that was given messages has published a table once it is finished; whoever puts it into a "
              "graph waits for one.",
              {"stage-takes-what-it-asks-for"}) {
    if (results(bench).empty()) FAIL("no table was published, neither on the way nor by finish");
}

PELORUS_CHECK(
    analyzer, "analyzer-layout-is-constant", 3,
    "A table of one name has the same columns and scalars whatever came in (where nothing did, those that are "
    "known): runs of a campaign are merged by them.",
    {"analyzer-tells-its-results"}) {
    const Tables full = results(bench);
    FeedOptions fewer;
    fewer.targets = 1;
    fewer.clutter = 0;
    FeedOptions none;
    none.ticks = 0;
    for (const FeedOptions& options : {fewer, none})
        for (const auto& [name, message] : results(bench, options)) {
            const auto found = full.find(name);
            if (found == full.end()) continue;
            const auto mine = layout_of(*message->body.table), all = layout_of(*found->second->body.table);
            const std::string extra = missing_in(mine, all);
            if (!extra.empty())
                FAIL(table_name(name) << " has the " << extra
                                      << (options.ticks == 0 ? " where nothing came in" : " with one target")
                                      << " and not with three targets");
            const std::string lost = options.ticks == 0 ? std::string() : missing_in(all, mine);
            if (!lost.empty()) FAIL(table_name(name) << " has the " << lost << " with three targets and not with one");
        }
}

PELORUS_CHECK(analyzer, "analyzer-numbers-are-finite", 3,
              "Numbers of results are finite, or NaN where there is nothing to tell: NaN is left out of a mean and "
              "counted, an infinite one spoils it.",
              {"analyzer-tells-its-results"}) {
    FeedOptions none;
    none.ticks = 0;
    for (const FeedOptions& options : {FeedOptions(), none})
        for (const auto& [name, message] : results(bench, options)) {
            const plr_table& table = *message->body.table;
            const char* const when = options.ticks == 0 ? " where nothing came in" : "";
            for (std::int64_t row = 0; row < table.rows.count; ++row)
                for (std::uint32_t c = 0; c < table.column_count; ++c)
                    if (std::isinf(number_at(table, row, c)))
                        FAIL("column " << element_of(table.columns, c).name << " of " << table_name(name)
                                       << " is infinite in row " << row << when);
            for (std::uint32_t s = 0; s < table.scalar_count; ++s)
                if (std::isinf(element_of(table.scalars, s).value))
                    FAIL("scalar " << element_of(table.scalars, s).name << " is infinite" << when);
        }
}

PELORUS_CHECK(analyzer, "analyzer-keys-are-unique", 3,
              "Rows of a table differ in their key columns: rows of different runs meet by them.",
              {"analyzer-tells-its-results"}) {
    for (const auto& [name, message] : results(bench)) {
        const plr_table& table = *message->body.table;
        std::set<std::vector<double>> seen;
        for (std::int64_t row = 0; row < table.rows.count; ++row) {
            std::vector<double> key;
            for (std::uint32_t c = 0; c < table.column_count; ++c)
                if (element_of(table.columns, c).reduce == PLR_REDUCE_KEY) key.push_back(number_at(table, row, c));
            if (key.empty()) break;
            if (!seen.insert(key).second)
                FAIL("row " << row << " of " << table_name(name) << " has the key of an earlier one, beginning with "
                            << key.front());
        }
    }
}

PELORUS_CHECK(analyzer, "analyzer-splitting-does-not-matter", 3,
              "Two times in one message of tracks or truth count like two messages: how entries are packed is the "
              "sender's affair.",
              {"analyzer-tells-its-results"}) {
    FeedOptions options;
    const StagePlayer probe(bench);
    if (!Feed::ports_of(probe.instance(), PLR_MESSAGE_SCAN).empty()) skip("scans are of one time");
    const Tables single = results(bench, options);
    options.ticks_a_message = 2;
    const Tables paired = results(bench, options);
    for (const auto& [name, message] : single) {
        const auto found = paired.find(name);
        if (found == paired.end()) FAIL(table_name(name) << " is not published where messages hold two times");
        const std::string difference = difference_of(*message->body.table, *found->second->body.table);
        if (!difference.empty())
            FAIL(table_name(name) << " differs between messages of one time and of two: " << difference);
    }
}

}  // namespace pelorus::conformance
