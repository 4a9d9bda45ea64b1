// Where a machine stands before the instrument that measures it, as the models "tracker" and "arm" of tables fit it:
// six numbers about what the table alone gives (Kabsch), a rotation vector about the rows' middle, applied on the left,
// and a shift. Frames: what is placed in the machine's base, what is seen in the instrument's. Metres, radians.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "explain/tables/table_model.h"
#include "geom/rigid.h"

namespace gonio::explain::tables {

struct Placement {
  std::string name;
  Rigid<frame::World, frame::Base> start;
  Vec3 middle_m;          // of its rows, in the instrument's frame
  std::size_t first = 0;  // of its parameters

  Vec3 seen(std::span<const double> values, Vec3 in_base_m) const;
};

// Sets `start` and `middle_m` from points that belong together: at least three, not on a line.
void start_from(Placement& placement, const std::vector<Vec3>& in_base_m, const std::vector<Vec3>& seen_m);

// Its six parameters, called `prefix` + turn_x_rad, ..., shift_z_m, all free in the base model. `groups`: the only ones
// that it moves; empty: all.
void declare_placement(Placement& placement, const std::string& prefix, const std::vector<std::size_t>& groups,
                       std::vector<Parameter>& parameters, std::vector<std::size_t>& base);

// Error(data) unless the table observes x_m, y_m and z_m; `model`: for the message.
void check_places_observed(const Table& table, const std::string& model);

// What the rows observe.
std::vector<Vec3> observed_places(const Table& table);

// Rows by the value of a column of names or numbers, in the order in which they appear; without such a column they are
// all one.
struct RowsByName {
  std::vector<std::string> names;
  std::vector<std::size_t> of_row;  // place in `names`
};
RowsByName rows_by_name(const Table& table, const std::string& column);

}  // namespace gonio::explain::tables
