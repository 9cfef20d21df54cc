#pragma once

// The old name of this header.
#include "pdoik/interior_spheres.hpp"
