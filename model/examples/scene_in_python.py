"""A scene from Python: three methods, and a hand that comes nearer.

The module `fringe` has the same methods as the C++ library. `Scene.capacitance` gives what the sensors feel, by the fast model if no
accuracy is asked for, else by the cheapest method that states it; `Scene.maxwell` gives the Maxwell matrix by boundary elements.

Run it:  PYTHONPATH=build/python python3 model/examples/scene_in_python.py
Expect:  the model and the matrix differ by tens of percent, "auto" and the matrix by less than one.

Output:
  height, mm    exact, pF    auto, pF    matrix, pF
           0        2.676        3.86         3.857
          20        1.561        2.46         2.457
          50        0.967        1.62         1.623
         100        0.593        1.04         1.041
"""

from pathlib import Path

import numpy as np

import fringe

scene = fringe.Scene.load(str(Path(__file__).with_name("hand.toml")))
print("height, mm    exact, pF    auto, pF    matrix, pF")
for height in (0.0, 0.02, 0.05, 0.1):
    scene.set_pose("arm", [0, 0, height], np.eye(3))
    exact = scene.capacitance()["sensors"][0]["total"]
    automatic = scene.capacitance("auto", rtol=1e-2, entries=True)["sensors"][0]["total"]
    mutual = -scene.maxwell(rtol=1e-4)["maxwell"][0, 1]
    print(f"{1000 * height:10.0f}    {1e12 * exact:9.3f}    {1e12 * automatic:8.2f}    {1e12 * mutual:10.3f}")
