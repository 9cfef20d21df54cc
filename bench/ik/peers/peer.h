// What the Python of bench/ calls through ctypes: one library per peer, all with these functions.
// Metres, radians, seconds; matrices row-major.
#pragma once

#pragma GCC visibility push(default)
extern "C" {

struct Peer;

struct PeerSetup {
  const char* urdf_path;
  const char* tip_link;        // goals are for this link
  const char* occupancy_yaml;  // hulls, for peers that know obstacles; may be null
  int axis_goal;               // 0: the whole pose, 1: position and direction of the tip's z
  double position_tolerance;
  double rotation_tolerance;
  double clearance_tolerance;  // for peers that may come this near; the others keep clear
  double max_time;             // of a solve
  unsigned seed;               // of the starts it draws
};

struct PeerProblem {
  const double* T_base_tip;  // (4, 4), the target
  const double* q0;          // first start; null for the peer's own
  const double* obstacles;   // (obstacle_count, obstacle_columns); null if there are none
  int obstacle_count;
  int obstacle_columns;  // 3: x y z, 4: x y z radius
};

struct PeerAnswer {
  double* q;        // room for the answer, one number per joint
  double time;      // of the solve alone, by the steady clock
  int success;      // in the peer's own opinion, and within max_time
  int iterations;   // over all starts
  int evaluations;  // forward kinematics, over all starts; those of the obstacle check apart
  int restarts;     // starts beyond the first
};

/// Null on failure, with the reason in peer_error().
Peer* peer_create(const PeerSetup* setup);
void peer_destroy(Peer* peer);
const char* peer_error();
/// 0, or -1 if the problem is of a kind the peer does not know.
int peer_solve(Peer* peer, const PeerProblem* problem, PeerAnswer* answer);

}  // extern "C"
#pragma GCC visibility pop
