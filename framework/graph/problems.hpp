/// Collects all that is wrong with a config, so that one pass tells everything.
#pragma once

#include <string>
#include <vector>

#include "host/error.hpp"

namespace pelorus::graph {

struct Value;

class Problems {
public:
    void add(const Location& where, std::string text);
    bool empty() const noexcept { return items_.empty(); }
    std::size_t count() const noexcept { return items_.size(); }
    const std::vector<ConfigError::Item>& items() const noexcept { return items_; }
    /// Throws ConfigError if there is anything.
    void raise() const;

private:
    std::vector<ConfigError::Item> items_;
};

/// The candidate that a word probably stands for: the nearest, one that differs in capitals only, or the config's own word for
/// what other programs call by that one (`plugin`: `use`). "" if there is none.
std::string meant(const std::string& word, const std::vector<std::string>& candidates);

/// `; did you mean 'noise'?` if a candidate is near, followed by the candidates (`; parameters: a, b`) if they are few.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates, const std::string& plural);

/// Tells the keys of a map that are none of `keys`, after `prefix`; without a prefix, keys that begin with `x-` are free.
void check_keys(const Value& map, const std::vector<std::string>& keys, const std::string& prefix, Problems& problems);

/// Without the blanks and tabs around it.
std::string trimmed(const std::string& text);

/// `a, b, c`
std::string join(const std::vector<std::string>& words, const std::string& separator = ", ");

/// `an estimator`, `a motion`
std::string with_article(const std::string& noun);

}  // namespace pelorus::graph
