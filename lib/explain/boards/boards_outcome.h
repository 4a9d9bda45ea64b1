// What surrounds the boards problem: the conditions of a corner, the upgraded cameras and boards, the pictures. Private
// to boards/.
#pragma once
#include <vector>

#include "explain/boards/boards_problem.h"
#include "explain/boards/rolling_shutter.h"
#include "explain/explanation.h"

namespace gonio::explain {

// What a parameter of the problem moves: a column of MovingColumn of one camera, board or view; the others are none.
struct BoardRole {
  std::size_t camera = static_cast<std::size_t>(-1), board = static_cast<std::size_t>(-1),
              view = static_cast<std::size_t>(-1);
  std::size_t column = 0;
};

// Conditions without values, and the two rows (u, v) of one corner appended to each.
std::vector<Condition> board_conditions();
void append_conditions(const BoardsInput::Camera& camera, const BoardsInput::Board& board,
                       const BoardsInput::View& view, const BoardsInput::Corner& corner,
                       std::vector<Condition>& conditions);

void upgrade_boards(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                    const Explanation& explanation, manifest::Document& document);
Illustration illustrate_boards(const BoardsInput& input, const Observations& observations,
                               const Explanation& explanation);

}  // namespace gonio::explain
