#pragma once

#include <memory>

#include "peer.h"

/// What stands behind the functions of peer.h. interface.cpp defines those, once for all peers.
struct Peer {
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  /// @returns whether the problem is of a kind the peer knows.
  virtual bool solve(const PeerProblem& problem, PeerAnswer& answer) = 0;
};

namespace pdoik::bench {

/// Each peer defines this one.
/// @throws std::exception  The peer cannot be made, or does not know such goals.
std::unique_ptr<Peer> make_peer(const PeerSetup& setup);

}  // namespace pdoik::bench
