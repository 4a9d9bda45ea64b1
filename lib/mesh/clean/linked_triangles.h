// Triangles that know who is behind each of their edges, and collapse one edge after the other. Half-edge 3 t + c leads
// from corner c of triangle t to the next; its twin leads the other way in the triangle behind, or there is none at a
// border. Nothing moves but indices: 24 bytes a triangle, which is what makes a collapse cheap.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace gonio::mesh {

class LinkedTriangles {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  // Error(data) where triangles meet in no surface: an edge passed twice the same way, or corners whose triangles form
  // more than one fan.
  LinkedTriangles(const std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t vertices);

  std::size_t triangles() const { return corner_.size() / 3; }
  std::size_t vertices() const { return out_.size(); }
  bool gone(std::uint32_t triangle) const { return corner_[3 * std::size_t{triangle}] == none; }
  bool isolated(std::uint32_t vertex) const { return out_[vertex] == none; }
  bool at_border(std::uint32_t vertex) const { return twin_[out_[vertex]] == none; }
  std::uint32_t corner(std::uint32_t triangle, std::size_t c) const { return corner_[3 * std::size_t{triangle} + c]; }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t before(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(std::uint32_t h) const { return corner_[h]; }
  std::uint32_t to(std::uint32_t h) const { return corner_[next(h)]; }
  std::uint32_t apex(std::uint32_t h) const { return corner_[before(h)]; }  // of its triangle
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }

  // body(h) for the half-edges that leave a vertex, counter-clockwise; false ends it.
  template <class Body>
  void around(std::uint32_t vertex, const Body& body) const {
    const std::uint32_t first = out_[vertex];
    for (std::uint32_t h = first; h != none;) {
      const std::uint32_t in = before(h);
      if (!body(h)) return;
      h = twin_[in];
      if (h == first) return;
    }
  }

  // An edge with a direction; at a border one of its sides is none.
  struct Edge {
    std::uint32_t from = none, to = none;
    std::uint32_t left = none, right = none;  // half-edges: from -> to, and to -> from
    bool border() const { return left == none || right == none; }
    bool valid() const { return from != none; }
  };
  // body(edge) for all edges from a vertex, counter-clockwise; false ends it.
  template <class Body>
  void edges_from(std::uint32_t vertex, const Body& body) const {
    const std::uint32_t first = out_[vertex];
    for (std::uint32_t h = first; h != none;) {
      if (!body(Edge{vertex, to(h), h, twin_[h]})) return;
      const std::uint32_t in = before(h);
      h = twin_[in];
      if (h == none) body(Edge{vertex, from(in), none, in});
      if (h == first) return;
    }
  }
  // Neighbours, but no more than `most` are counted.
  int neighbours(std::uint32_t vertex, int most) const;

  // Whether the surface stays one, of the same topology, if `from` went to where `to` is: the link condition (Dey et
  // al. 1999), and what lies beside keeps three neighbours.
  bool can_collapse(const Edge& edge) const;
  // Returns how many triangles that takes away: one at a border, else two.
  std::size_t collapse(const Edge& edge);

 private:
  void link_twins();
  void find_first_of_fans();
  std::uint32_t join_outside(std::uint32_t h);
  std::uint32_t first_of_fan(std::uint32_t h) const;

  std::vector<std::uint32_t> corner_, twin_, out_;
  mutable std::vector<std::uint32_t> stamps_;  // of the link condition
  mutable std::uint32_t stamp_ = 0;
};

}  // namespace gonio::mesh
