import sys, byre, numpy as np, matplotlib.pyplot as plt  # draw_map.py MAP.byre PICTURE.png

room = byre.Map.load(sys.argv[1])
path = room.trajectory().poses[:, :3, 3]
plane = np.linalg.svd(path - path.mean(axis=0), full_matrices=False)[2][:2].T  # 3x2, plane of the path
seen = room.observation_counts > 2
plt.scatter(*(room.positions[seen] @ plane).T, c=room.grey_values[seen], s=2, cmap="gray")
plt.plot(*(path @ plane).T, "g.-")
plt.axis("equal")
plt.savefig(sys.argv[2])
