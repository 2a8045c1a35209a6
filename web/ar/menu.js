// SPDX-License-Identifier: Apache-2.0
//
// The menu in the room, for headsets that show no web page during a session: a board of buttons that a ray presses. It
// shows what the page's own buttons show, and presses them.
import * as THREE from "vendor/three/three.module.js";

const kWidth_m = 0.3;
const kHeight_m = 0.06;
const kGap_m = 0.01;

function drawButton(button, canvas) {
  const context = canvas.getContext("2d");
  const pressed = button.getAttribute("aria-pressed") === "true";
  context.fillStyle = pressed ? "#ffe08a" : button.disabled ? "#aab2bd" : "#ffffff";
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = "#1b1f24";
  context.font = "bold 44px sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(button.textContent, canvas.width / 2, canvas.height / 2, canvas.width - 20);
}

function plate(width, height) {
  const canvas = document.createElement("canvas");
  canvas.width = 640;
  canvas.height = Math.round((640 * height) / width);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(width, height), new THREE.MeshBasicMaterial({ map: texture }));
  return { mesh, canvas, texture };
}

export class RoomMenu {
  // `buttons`: the page's; `status`: the element whose text is shown above them.
  constructor(buttons, status) {
    this.group = new THREE.Group();
    this.status = status;
    this.plates = buttons.map((button, i) => {
      const made = { ...plate(kWidth_m, kHeight_m), button };
      made.mesh.position.y = -i * (kHeight_m + kGap_m);
      this.group.add(made.mesh);
      return made;
    });
    this.statusPlate = plate(2 * kWidth_m, kHeight_m);
    this.statusPlate.mesh.position.y = kHeight_m + 2 * kGap_m;
    this.group.add(this.statusPlate.mesh);
  }

  // In front of a viewer, at the height of the chest, facing him.
  placeBefore(viewer) {
    const ahead = new THREE.Vector3(0, 0, -1).applyQuaternion(viewer.quaternion).setY(0).normalize();
    this.group.position.copy(viewer.position).addScaledVector(ahead, 0.8);
    this.group.position.y = viewer.position.y + 0.05;
    this.group.rotation.set(0, Math.atan2(-ahead.x, -ahead.z), 0);
  }

  refresh() {
    for (const { button, canvas, texture } of this.plates) {
      drawButton(button, canvas);
      texture.needsUpdate = true;
    }
    drawButton(this.status, this.statusPlate.canvas);
    this.statusPlate.texture.needsUpdate = true;
  }

  // Presses the button that a ray hits; false when it hits none.
  press(raycaster) {
    const [hit] = raycaster.intersectObjects(this.plates.map(({ mesh }) => mesh));
    if (!hit) return false;
    this.plates.find(({ mesh }) => mesh === hit.object).button.click();
    return true;
  }
}
