// Known answers of tests/reference as matrices.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace test_support {

inline nlohmann::json reference(const std::string& file) {
    const std::string path = std::string(PELORUS_SOURCE_DIR) + "/tests/reference/" + file;
    std::ifstream stream(path);
    if (!stream) throw std::runtime_error("cannot open " + path);
    return nlohmann::json::parse(stream);
}

/// A list of rows, or a list of numbers as a column.
inline Eigen::MatrixXd matrix(const nlohmann::json& rows) {
    const bool column = !rows.at(0).is_array();
    Eigen::MatrixXd out(static_cast<Eigen::Index>(rows.size()),
                        static_cast<Eigen::Index>(column ? 1 : rows.at(0).size()));
    for (Eigen::Index r = 0; r < out.rows(); ++r) {
        const auto& row = rows.at(static_cast<std::size_t>(r));
        for (Eigen::Index c = 0; c < out.cols(); ++c)
            out(r, c) = column ? row.get<double>() : row.at(static_cast<std::size_t>(c)).get<double>();
    }
    return out;
}

/// Rows (and columns) in another order: out row i is row order[i].
inline Eigen::MatrixXd reordered(const Eigen::MatrixXd& in, const std::vector<int>& rows,
                                 const std::vector<int>& cols) {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(cols.size()));
    for (Eigen::Index r = 0; r < out.rows(); ++r)
        for (Eigen::Index c = 0; c < out.cols(); ++c)
            out(r, c) = in(rows[static_cast<std::size_t>(r)], cols[static_cast<std::size_t>(c)]);
    return out;
}

}  // namespace test_support
