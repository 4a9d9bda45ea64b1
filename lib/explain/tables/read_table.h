// From the manifest's "tables" to numbers in SI: a file of columns with names (goniometry/tables/tables_text.h),
// Cornell's .brdf or MERL's .binary (goniometry/tables/sample_table.h), a JSON file {"units": {...}, "rows": [{column:
// value, ...},
// ...]}, or rows inline. Units come from the manifest's `columns` (SI), and where the file's own heading states one
// ("theta_i [deg]"), values are converted from that. Where a table names no sigma, columns named after the observed
// ones are taken: f_sigma is that of f.
//
// Groups, which are held out together: equal values (to a millionth of their range) of the table's `group` column, of
// the model's own, or of `series`; without these, the rows are cut into contiguous stretches along the telling column
// (equal values stay together), so that a model is judged where it interpolates and at both ends extrapolates.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "explain/tables/table_model.h"
#include "explain/tables/unit.h"

namespace gonio::explain::tables {

constexpr std::size_t fewest_rows = 12, fewest_groups = 3, groups_of_a_stretch = 12;

// Columns as they stand, before grouping: what a new manifest's `columns` says.
struct RawTable {
  std::vector<std::string> columns;
  std::vector<Unit> units;                       // of the values as written; converted by read_table()
  std::vector<std::vector<double>> values;       // SI
  std::vector<std::vector<std::string>> labels;  // columns of names
};
// `section` says which columns, their units, observed and sigma; an empty `columns` takes all that there are.
RawTable read_raw(const std::filesystem::path& path, const manifest::Table& section, const std::string& place);
RawTable read_inline(const manifest::Table& section, const std::string& place);  // its `rows`

// `usual`: column of groups where the section names none. `telling`: columns along which groups are cut where none are
// stated, the first that is there and varies. Error(data) with file and line, or at the table: unknown columns, no
// numbers, sigma <= 0, too few rows or groups.
Table read_table(const manifest::Document& document, const std::string& name, const std::string& usual = {},
                 const std::vector<std::string>& telling = {});
// Further takes of the same table: rows in any order, matched by their conditions (all columns but the observed ones,
// their sigma, and time). One vector of observations per row of `table` (row by row, as observations are numbered) for
// each file; NaN where a take lacks the row.
std::vector<std::vector<double>> read_repeats(const std::vector<std::filesystem::path>& files,
                                              const manifest::Table& section, const Table& table);

}  // namespace gonio::explain::tables
