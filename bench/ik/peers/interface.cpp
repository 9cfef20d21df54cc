#include "interface.hpp"

#include <exception>
#include <string>

static std::string last_error;

Peer* peer_create(const PeerSetup* setup) try {
  return pdoik::bench::make_peer(*setup).release();
} catch (const std::exception& error) {
  last_error = error.what();
  return nullptr;
}

void peer_destroy(Peer* peer) { delete peer; }

const char* peer_error() { return last_error.c_str(); }

int peer_solve(Peer* peer, const PeerProblem* problem, PeerAnswer* answer) {
  return peer->solve(*problem, *answer) ? 0 : -1;
}
