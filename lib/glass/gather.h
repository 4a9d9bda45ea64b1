// A set whose cells are made, put together: tensors by share, and a table of the cells for the statistics.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "glass/set.h"

namespace gonio::glass {

struct CellRow {
  std::size_t number = 0, object = 0, view = 0;
  Share share = Share::training;
  std::string name;
  std::map<std::string, std::string> facts;
  double coverage = 0;         // share of the pixels that meet the object
  double mean_interfaces = 0;  // of the rays that do
  int most_interfaces = 0;
  std::map<std::string, double> relative_error, spp;  // by image
};
struct Gathered {
  std::vector<CellRow> rows;
  std::vector<std::size_t> interfaces;  // pixels of all cells by depth (make_cell.h)
  std::vector<std::filesystem::path> tensors;
};

// Below `folder`/tensors. Error(data) that counts the cells that are missing and names the first.
// `on_cell` hears of each that is done.
Gathered gather(const GlassSet& set, const std::filesystem::path& folder, const std::function<void()>& on_cell);

// number,name,share,object,view, the facts, coverage, ... One line a cell.
std::string table_of(const Gathered& gathered);

}  // namespace gonio::glass
