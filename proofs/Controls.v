(* Controls. The conditions of Theorem 1 can be met; and with one of them left out, it is false: a world in which all the
   others hold, and ego and other overlap. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Statement Shield.
Import ListNotations.
Open Scope R_scope.

(** * Worlds *)

(* One ego that brakes from call to call, one other, one zone; everything is sensed exactly, at every second. *)
Section World.
Variables (k : contract) (z : zone) (s v t w : R -> R).
Hypothesis unit_period : period k = 1.
Hypothesis at_once : latency k = 0 /\ jitter k = 0.
Hypothesis exactly : position_error k = 0 /\ speed_error k = 0.
Hypothesis brakes_pos : 0 < ego_braking k /\ 0 < ego_acceleration k.
Hypothesis ego_moves : motion s v.
Hypothesis ego_brakes : forall x y, 1 <= x -> x <= y -> v y = Rmax 0 (v x - ego_braking k * (y - x)).

Definition world_log : log := {|
  ego_at i := {| own_s := s (INR i); own_v := v (INR i); own_least := s (INR i) |};
  previous_least _ := - ego_braking k; previous_most _ := - ego_braking k; goes _ := O |}.
Definition world_commands (_ : nat) := - ego_braking k.
Definition world_view (_ : unit) (i : nat) := sensed k (t (INR i)) (w (INR i)).
Definition world_other : other unit := {|
  place := t; rate := w; on := tt; since := 1%nat; candidates _ _ := True; view := world_view; claims _ _ _ := False |}.

Lemma later_than_one i : 1 <= INR (S i).
Proof. rewrite S_INR. pose proof (pos_INR i). lra. Qed.

Lemma world_obeys : obeys k v INR world_commands.
Proof.
  assert (up : forall x y, 1 <= x -> speeds_up_at_most v (- ego_braking k) x y).
  { intros x y x1 p q ? ? ?. rewrite (ego_brakes p q) by lra.
    replace (v p - ego_braking k * (q - p)) with (v p + - ego_braking k * (q - p)) by ring. lra. }
  assert (down : forall x y, 1 <= x -> speeds_up_at_least v (- ego_braking k) (unheld k) x y).
  { intros x y x1 p q ? ? ?. rewrite (ego_brakes p q) by lra.
    apply Rle_trans with (1 := Rmin_l _ _). apply Rle_trans with (2 := Rmax_r _ _). lra. }
  constructor; unfold world_commands; intros i; pose proof (later_than_one i);
    rewrite ?Rmax_left, ?Rmin_left by lra; try apply up; try apply down; lra.
Qed.

Lemma world_known i : (1 <= i)%nat -> known k t w 1 (INR i) (world_view tt i).
Proof.
  intros h. apply seen; try lra. destruct i; [lia | apply later_than_one].
Qed.

(* The plan in force brakes, and goes on. *)
Lemma world_carries i : carries_on k world_log world_commands i.
Proof. split; reflexivity. Qed.

Lemma world_conditions (contracts : contract -> Prop) (conduct : conducts) :
  contracts k -> conduct k unit (fun _ => [z]) s v INR world_commands world_log world_other ->
  (forall i, (1 <= i)%nat -> judged k world_log world_commands (world_view tt) z (fun _ => False) 1 i) ->
  Conditions contracts conduct k unit (fun _ => [z]) (fun _ => inside z) s v INR world_commands world_log
    (fun o => o = world_other).
Proof.
  intros good keeps judges.
  split; [exact good |].
  split; [intros _ x y ins; exists z; split; [left; reflexivity | exact ins] |].
  split; [exact ego_moves |].
  split; [exists 0; intros i; rewrite unit_period; lra |].
  split; [exact world_obeys |].
  split; [intros i; unfold own_holds, world_commands; cbn; lra |].
  split; [intros o ->; exact keeps |].
  intros o i p zz -> h _ [<- | []]. destruct p. apply judges. exact h.
Qed.

(* A world in which they overlap. *)
Lemma overlap_refutes (contracts : contract -> Prop) (conduct : conducts) u :
  contracts k -> conduct k unit (fun _ => [z]) s v INR world_commands world_log world_other ->
  (forall i, (1 <= i)%nat -> judged k world_log world_commands (world_view tt) z (fun _ => False) 1 i) ->
  1 <= u -> inside z (s u) (t u) -> ~ Guarantee contracts conduct.
Proof.
  intros good keeps judges lo ins guaranteed.
  apply (guaranteed _ _ _ _ _ _ _ _ _ _ (world_conditions contracts conduct good keeps judges) world_other u eq_refl lo).
  exact ins.
Qed.
End World.

(** * Motions *)

Lemma rest_moves p : motion (fun _ => p) (fun _ => 0).
Proof. constructor; intros; [auto_derive; [trivial | reflexivity] | lra]. Qed.

Lemma steady_moves p q : 0 <= q -> motion (fun u => p + q * u) (fun _ => q).
Proof. constructor; intros; [auto_derive; [trivial | ring] | assumption]. Qed.

(* It gets faster and faster from time 1 on. *)
Lemma cubic_moves : motion (fun u => 100 / 3 * ((u - 1) * (u - 1) * (u - 1))) (fun u => 100 * ((u - 1) * (u - 1))).
Proof.
  constructor; intros; [auto_derive; [trivial | field] |].
  assert (0 <= (t - 1) * (t - 1)) by apply Rle_0_sqr. lra.
Qed.

(* Every speed that is continuous and not negative belongs to a motion. *)
Lemma moves_by (v : R -> R) : (forall x : R, continuous v x) -> (forall x, 0 <= v x) -> motion (fun u => RInt v 1 u) v.
Proof.
  intros cont pos. constructor; [| exact pos].
  intros x. apply (is_derive_RInt v (fun u => RInt v 1 u) 1 x); [| apply cont].
  exists (mkposreal 1 Rlt_0_1). intros y _. apply (RInt_correct v 1 y).
  apply (ex_RInt_continuous v). intros; apply cont.
Qed.

Lemma Rmax_zero x : Rmax 0 x = (x + Rabs x) / 2.
Proof. unfold Rabs. destruct (Rcase_abs x); [rewrite Rmax_left | rewrite Rmax_right]; lra. Qed.

Lemma continuous_positive (f : R -> R) (x : R) : continuous f x -> continuous (fun u => Rmax 0 (f u)) x.
Proof.
  intros c. apply (continuous_ext (fun u => (f u + Rabs (f u)) / 2)).
  { intros u. symmetry. apply Rmax_zero. }
  apply (continuous_mult (fun u => f u + Rabs (f u)) (fun _ => / 2)); [| apply continuous_const].
  apply (continuous_plus f (fun u => Rabs (f u)) x c).
  apply continuous_comp; [exact c | apply continuous_Rabs].
Qed.

(* Braking at b from speed V at time 1 on. *)
Definition braked V b u := Rmax 0 (V - b * Rmax 0 (u - 1)).

Lemma braked_moves V b : motion (fun u => RInt (braked V b) 1 u) (braked V b).
Proof.
  apply moves_by; [| intros; apply Rmax_l].
  intros x. apply (continuous_positive (fun u => V - b * Rmax 0 (u - 1))).
  apply (continuous_minus (fun _ => V) (fun u => b * Rmax 0 (u - 1))); [apply continuous_const |].
  apply (continuous_mult (fun _ => b) (fun u => Rmax 0 (u - 1))); [apply continuous_const |].
  apply continuous_positive. apply (continuous_minus (fun u => u) (fun _ => 1)); [apply continuous_id | apply continuous_const].
Qed.

Lemma braked_brakes V b x y : 0 < b -> 1 <= x -> x <= y -> braked V b y = Rmax 0 (braked V b x - b * (y - x)).
Proof.
  intros b0 lo le. unfold braked. rewrite !(Rmax_right 0 (_ - 1)) by lra.
  assert (b * (x - 1) + b * (y - x) = b * (y - 1)) by ring. assert (0 <= b * (y - x)) by nra. cases; lra.
Qed.

(** * Contracts *)

(* A contract of round numbers. *)
Definition round (b bh f slk : R) : contract := {|
  period := 1; latency := 0; jitter := 0; position_error := 0; speed_error := 0; slack := slk;
  ego_max_speed := 10; ego_acceleration := 1; ego_go := 1; ego_braking := b;
  other_max_speed := 10; other_acceleration := 1; other_braking := bh;
  follower_reaction := 1; follower_braking := f; precedence_braking := 1 |}.

Lemma round_valid b bh f slk : 1 <= b -> b <= bh -> 0 < f -> f <= bh -> 0 < slk -> valid (round b bh f slk).
Proof.
  intros. constructor; unfold round, hardest, unheld, switching; cbn; try lra.
  apply Rle_trans with b; [lra | apply Rmax_l].
Qed.

(* A lane in which the ego stands at 10 m. *)
Definition long_lane : zone := {|
  s_in := 0; s_out := 20; t_in := 0; t_out := 20; lead_from := -1; lead_to := 1; lane := true |}.

(* Evaluates minima and maxima of numbers that are known. *)
Ltac evaluate := repeat match goal with
  | |- context [Rmax ?a ?b] => first [rewrite (Rmax_left a b) by lra | rewrite (Rmax_right a b) by lra]
  | |- context [Rmin ?a ?b] => first [rewrite (Rmin_left a b) by lra | rewrite (Rmin_right a b) by lra]
  end.

(** * The conditions can be met *)

(* The other stands far behind. *)
Theorem conditions_can_be_met : exists k path zones occupied s v tau c l others,
  Conditions valid keeps_all k path zones occupied s v tau c l others /\ exists o, others o.
Proof.
  pose (k := round 2 4 1 (1 / 100)).
  assert (conditions : Conditions valid keeps_all k unit (fun _ => [long_lane]) (fun _ => inside long_lane) (fun _ => 10)
    (fun _ => 0) INR (world_commands k) (world_log k (fun _ => 10) (fun _ => 0)) (fun o => o = world_other k (fun _ => 0) (fun _ => 0))).
  { assert (far : forall y x, y = 0 -> x = 0 -> safe_gap k y x <= 8).
    { intros y x -> ->. rewrite Ego.safe_gap_is. unfold rest_of, rush, start, k, round, hardest; cbn. evaluate. lra. }
    assert (settled_now : forall i, (1 <= i)%nat ->
      settled k (world_log k (fun _ => 10) (fun _ => 0)) (world_commands k) (world_view k (fun _ => 0) (fun _ => 0) tt) long_lane 1 i).
    { intros i hi. exists 1%nat. split; [lia |]. split; [reflexivity |]. split.
      - unfold is_ahead. cbn. lra.
      - right; left. unfold gap_ahead. cbn. evaluate. apply Rle_trans with 8; [apply far | lra]; try lra; rewrite Rmax_right; lra. }
    apply world_conditions; try reflexivity; try (cbn; lra).
    - apply rest_moves.
    - intros. cbn. evaluate. reflexivity.
    - apply round_valid; lra.
    - constructor; cbn.
      + apply (rest_moves 0).
      + split; intros u x y ? ? ?; cbn; cases; lra.
      + intros i hi. apply (world_known k (fun _ => 0) (fun _ => 0)); [split; reflexivity | exact hi].
      + intros zz [<- | []] _ T u ? ? ? gap _ _. exists T. split; [lra |]. split; [exact gap |].
        intros x y ? ? ?. evaluate. cases; lra.
      + intros zz [<- | []] i0 i _ [].
      + intros zz [<- | []] _ _. unfold safe. apply Rle_trans with 8; [apply far; reflexivity | cbn; lra].
      + trivial.
      + lia.
    - intros i hi. right; left. apply settled_now. exact hi. }
  exists k, unit, (fun _ => [long_lane]), (fun _ => inside long_lane), (fun _ => 10), (fun _ => 0), INR, (world_commands k),
    (world_log k (fun _ => 10) (fun _ => 0)), (fun o => o = world_other k (fun _ => 0) (fun _ => 0)).
  split; [exact conditions |]. eexists. reflexivity.
Qed.

(** * What cannot be left out *)

(* keeps_all but for one condition. *)
Definition without_C6 : conducts := fun k path zones s v tau c l o =>
  motion (place o) (rate o) /\ keeps_contract k (rate o) (tau (since o)) /\
  (forall i, (since o <= i)%nat -> known k (place o) (rate o) (tau (since o)) (tau i) (view o (on o) i)) /\
  (forall z, In z (zones (on o)) -> lane z = true -> is_ahead k l (view o (on o)) z (since o) ->
    safe k z (s (tau (since o))) (v (tau (since o))) (place o (tau (since o))) (rate o (tau (since o)))) /\
  (forall i, (since o <= i)%nat -> candidates o i (on o)) /\ (1 <= since o)%nat.

Definition without_A9 : conducts := fun k path zones s v tau c l o =>
  motion (place o) (rate o) /\ keeps_contract k (rate o) (tau (since o)) /\
  (forall i, (since o <= i)%nat -> known k (place o) (rate o) (tau (since o)) (tau i) (view o (on o) i)) /\
  (forall z, In z (zones (on o)) -> lane z = true -> keeps_distance k z s v (place o) (rate o) (tau (since o))) /\
  (forall i, (since o <= i)%nat -> candidates o i (on o)) /\ (1 <= since o)%nat.

(* Of C2 the braking is left. *)
Definition without_acceleration_bound : conducts := fun k path zones s v tau c l o =>
  motion (place o) (rate o) /\
  (forall u, brakes_at_most (rate o) (other_braking k) (tau (since o)) u) /\
  (forall i, (since o <= i)%nat -> known k (place o) (rate o) (tau (since o)) (tau i) (view o (on o) i)) /\
  (forall z, In z (zones (on o)) -> lane z = true -> keeps_distance k z s v (place o) (rate o) (tau (since o))) /\
  (forall z, In z (zones (on o)) -> lane z = true -> is_ahead k l (view o (on o)) z (since o) ->
    safe k z (s (tau (since o))) (v (tau (since o))) (place o (tau (since o))) (rate o (tau (since o)))) /\
  (forall i, (since o <= i)%nat -> candidates o i (on o)) /\ (1 <= since o)%nat.

(* The ego stands in the lane, and the gap is safe: so the zone is settled at every call. *)
Lemma settled_world k t w :
  lane long_lane = true -> position_error k = 0 -> speed_error k = 0 ->
  t 1 <= 9 -> safe_gap k (w 1) 0 <= 10 - t 1 - 1 ->
  forall i, (1 <= i)%nat ->
    judged k (world_log k (fun _ => 10) (fun _ => 0)) (world_commands k) (world_view k t w tt) long_lane (fun _ => False) 1 i.
Proof.
  intros _ pe se t1 gap i hi. right; left. exists 1%nat. split; [lia |]. split; [reflexivity |]. split.
  - unfold is_ahead. cbn. rewrite pe. lra.
  - right; left. unfold gap_ahead. cbn. rewrite pe, se.
    assert (W : safe_gap k (Rmax (w 1 + 0) 0) (Rmax (0 - 0) 0) = safe_gap k (w 1) 0).
    { unfold safe_gap. replace (w 1 + 0) with (w 1) by ring. replace (0 - 0) with 0 by ring.
      rewrite (Rmax_left (Rmax (w 1) 0) 0) by apply Rmax_r. rewrite (Rmax_left (Rmax 0 0) 0) by apply Rmax_r. reflexivity. }
    rewrite W, (Rmax_right 0 10) by lra. lra.
Qed.

Lemma nonneg_1 : 0 <= 1. Proof. lra. Qed.

(* Steady motion at 1 m/s keeps C2. *)
Lemma steady_keeps b bh f slk from : 0 < bh -> keeps_contract (round b bh f slk) (fun _ => 1) from.
Proof.
  split; intros u x y ? ? ?; cbn; [cases; lra |]. assert (0 <= bh * (y - x)) by (apply Rmult_le_pos; lra). lra.
Qed.

(* C6: a follower that keeps no distance. *)
Theorem C6_is_needed : ~ Guarantee valid without_C6.
Proof.
  pose (k := round 2 4 1 (1 / 100)).
  assert (gap : safe_gap k 1 0 <= 7).
  { rewrite Ego.safe_gap_is. unfold rest_of, rush, start, k, round, hardest; cbn. evaluate. lra. }
  apply (overlap_refutes k long_lane (fun _ => 10) (fun _ => 0) (fun u => 0 + 1 * u) (fun _ => 1)) with (u := 10);
    try reflexivity; try (unfold inside; cbn; lra).
  - apply rest_moves.
  - intros. cbn. evaluate. reflexivity.
  - apply round_valid; lra.
  - split; [apply (steady_moves 0 1 nonneg_1) |]. split; [apply steady_keeps; lra |].
    split; [intros i hi; apply (world_known k (fun u => 0 + 1 * u) (fun _ => 1)); [split; reflexivity | exact hi] |].
    split; [| split; [cbn; trivial | cbn; lia]].
    intros zz [<- | []] _ _. unfold safe. apply Rle_trans with (1 := gap). cbn. lra.
  - apply settled_world; try reflexivity; [lra |]. cbn. apply Rle_trans with 7; [exact gap | lra].
Qed.

(* A9: a follower that is too near at first. *)
Theorem A9_is_needed : ~ Guarantee valid without_A9.
Proof.
  pose (k := round 2 4 1 (1 / 100)).
  assert (gap : 2 <= safe_gap k 1 0).
  { rewrite Ego.safe_gap_is. unfold rest_of, rush, start, k, round, hardest; cbn. evaluate. lra. }
  apply (overlap_refutes k long_lane (fun _ => 10) (fun _ => 0) (fun u => 15 / 2 + 1 * u) (fun _ => 1)) with (u := 2);
    try reflexivity; try (unfold inside; cbn; lra).
  - apply rest_moves.
  - intros. cbn. evaluate. reflexivity.
  - apply round_valid; lra.
  - split; [apply (steady_moves (15 / 2) 1 nonneg_1) |]. split; [apply steady_keeps; lra |].
    split; [intros i hi; apply (world_known k (fun u => 15 / 2 + 1 * u) (fun _ => 1)); [split; reflexivity | exact hi] |].
    split; [| split; [cbn; trivial | cbn; lia]].
    intros zz [<- | []] _ T u lo ? ? near _ _. exfalso. unfold safe in near. cbn in lo, near.
    change (safe_gap _ 1 0) with (safe_gap k 1 0) in near. lra.
  - intros i hi. right; left. exists 1%nat. split; [lia |]. split; [reflexivity |]. split; [| right; right; reflexivity].
    unfold is_ahead. cbn. lra.
Qed.

(* C2: an other that accelerates harder and harder. *)
Theorem C2_acceleration_is_needed : ~ Guarantee valid without_acceleration_bound.
Proof.
  pose (k := round 2 4 1 (1 / 100)).
  pose (t := fun u => 100 / 3 * ((u - 1) * (u - 1) * (u - 1))).
  pose (w := fun u => 100 * ((u - 1) * (u - 1))).
  assert (w1 : w 1 = 0) by (unfold w; ring). assert (t1 : t 1 = 0) by (unfold t; ring).
  assert (gap : safe_gap k 0 0 <= 2).
  { rewrite Ego.safe_gap_is. unfold rest_of, rush, start, k, round, hardest; cbn. evaluate. lra. }
  apply (overlap_refutes k long_lane (fun _ => 10) (fun _ => 0) t w) with (u := 167 / 100);
    try reflexivity; try (unfold inside, t; cbn; lra).
  - apply rest_moves.
  - intros. cbn. evaluate. reflexivity.
  - apply round_valid; lra.
  - split; [apply cubic_moves |].
    split.
    { intros u x y lo ? ?. cbn in *. unfold w.
      assert ((x - 1) * (x - 1) <= (y - 1) * (y - 1)) by (apply Rmult_le_compat; lra). lra. }
    split; [intros i hi; apply (world_known k t w); [split; reflexivity | exact hi] |].
    split.
    { (* It leaves the lane before it has to react. *)
      intros zz [<- | []] _ T u lo le ? near _ before. exists T. split; [lra |]. split; [exact near |].
      intros x y late ? yu. exfalso. cbn in late, before, lo.
      assert (1 <= (u - 1) * (u - 1)) by nra. assert (1 <= (u - 1) * (u - 1) * (u - 1)) by nra. unfold t in before. lra. }
    split; [| split; [cbn; trivial | cbn; lia]].
    intros zz [<- | []] _ _. unfold safe. cbn. rewrite w1, t1. change (safe_gap _ 0 0) with (safe_gap k 0 0). lra.
  - apply settled_world; try reflexivity; [lra |]. rewrite w1, t1. lra.
Qed.

(* The slack must not be negative. *)
Definition with_slack (k : contract) (x : R) : contract := {|
  period := period k; latency := latency k; jitter := jitter k; position_error := position_error k;
  speed_error := speed_error k; slack := x;
  ego_max_speed := ego_max_speed k; ego_acceleration := ego_acceleration k; ego_go := ego_go k; ego_braking := ego_braking k;
  other_max_speed := other_max_speed k; other_acceleration := other_acceleration k; other_braking := other_braking k;
  follower_reaction := follower_reaction k; follower_braking := follower_braking k;
  precedence_braking := precedence_braking k |}.

Theorem slack_is_needed : ~ Guarantee (fun k => valid (with_slack k 1)) keeps_all.
Proof.
  pose (k := round 2 4 1 (-1)).
  pose (crossing := {| s_in := 19 / 2; s_out := 20; t_in := 0; t_out := 20; lead_from := -20; lead_to := 20; lane := false |}).
  apply (overlap_refutes k crossing (fun _ => 10) (fun _ => 0) (fun u => 0 + 1 * u) (fun _ => 1)) with (u := 10);
    try reflexivity; try (unfold inside; cbn; lra).
  - apply rest_moves.
  - intros. cbn. evaluate. reflexivity.
  - apply (round_valid 2 4 1 1); lra.
  - constructor.
    + apply (steady_moves 0 1 nonneg_1).
    + apply steady_keeps; lra.
    + intros i hi. apply (world_known k (fun u => 0 + 1 * u) (fun _ => 1)); [split; reflexivity | exact hi].
    + intros zz [<- | []]. discriminate.
    + intros zz [<- | []] i0 i _ [].
    + intros zz [<- | []]. discriminate.
    + cbn. trivial.
    + cbn. lia.
  - intros i hi. right; right; left. exists i. split; [lia |]. split; [| intros; lia].
    left. unfold stops, stops_short, stop_limit, rests. cbn -[departure rest_of].
    unfold departs_at, departure, world_log, world_commands, rest_of, shortest_period, switching, k, round. cbn.
    evaluate. lra.
Qed.

(* A1: a leader that brakes less hard than the ego. The gap is open at first and when both are at rest, and not between. *)
Definition with_other_braking (k : contract) (x : R) : contract := {|
  period := period k; latency := latency k; jitter := jitter k; position_error := position_error k;
  speed_error := speed_error k; slack := slack k;
  ego_max_speed := ego_max_speed k; ego_acceleration := ego_acceleration k; ego_go := ego_go k; ego_braking := ego_braking k;
  other_max_speed := other_max_speed k; other_acceleration := other_acceleration k; other_braking := x;
  follower_reaction := follower_reaction k; follower_braking := follower_braking k;
  precedence_braking := precedence_braking k |}.

Definition valid_but_A1 (k : contract) :=
  0 < other_braking k /\ follower_braking k <= other_braking k /\ exists x, valid (with_other_braking k x).

Theorem A1_is_needed : ~ Guarantee valid_but_A1 keeps_all.
Proof.
  pose (k := round 4 (1 / 4) (1 / 4) (1 / 100)).
  pose (wide := {| s_in := -10; s_out := 100; t_in := -10; t_out := 100; lead_from := -5; lead_to := 5; lane := true |}).
  pose (v := braked 4 4). pose (w := braked 1 (1 / 4)).
  pose (s := fun u => RInt v 1 u). pose (t := fun u => 502 / 100 + RInt w 1 u).
  assert (ms : motion s v) by apply braked_moves.
  assert (mt : motion t w).
  { destruct (braked_moves 1 (1 / 4)) as [d p]. constructor; [| exact p].
    intros x. replace (w x) with (0 + w x) by ring.
    apply (is_derive_plus (fun _ => 502 / 100) (fun u => RInt w 1 u)); [auto_derive; trivial | apply d]. }
  assert (s1 : s 1 = 0) by apply (RInt_point 1 v).
  assert (t1 : t 1 = 502 / 100) by (unfold t; rewrite (RInt_point 1 w); unfold zero; cbn; ring).
  assert (v1 : v 1 = 4) by (unfold v, braked; evaluate; ring).
  assert (w1 : w 1 = 1) by (unfold w, braked; evaluate; ring).
  (* After half a second. *)
  assert (sh : 3 / 2 <= s (3 / 2) - s 1).
  { pose proof (above_line s v 4 (- 4) 1 (3 / 2) ms ltac:(lra)) as A.
    apply Rle_trans with (2 := A ltac:(intros u [? ?]; unfold v, braked; rewrite (Rmax_right 0 (u - 1)) by lra;
      apply Rle_trans with (2 := Rmax_r _ _); lra)). lra. }
  assert (sl : s (3 / 2) - s 1 <= 2).
  { pose proof (below_line s v 4 0 1 (3 / 2) ms ltac:(lra)) as A.
    apply Rle_trans with (1 := A ltac:(intros u [? ?]; unfold v, braked; rewrite (Rmax_right 0 (u - 1)) by lra; cases; lra)). lra. }
  assert (th : t (3 / 2) - t 1 <= 1 / 2).
  { pose proof (below_line t w 1 0 1 (3 / 2) mt ltac:(lra)) as A.
    apply Rle_trans with (1 := A ltac:(intros u [? ?]; unfold w, braked; rewrite (Rmax_right 0 (u - 1)) by lra; cases; lra)). lra. }
  pose proof (advances t w 1 (3 / 2) mt ltac:(lra)) as tl.
  assert (wb : forall x y, 1 <= x -> x <= y -> w y = Rmax 0 (w x - 1 / 4 * (y - x))) by (intros; apply braked_brakes; lra).
  assert (vb : forall x y, 1 <= x -> x <= y -> v y = Rmax 0 (v x - 4 * (y - x))) by (intros; apply braked_brakes; lra).
  clearbody s t. clearbody v w.
  apply (overlap_refutes k wide s v t w) with (u := 3 / 2); try reflexivity; try (unfold inside; cbn; lra).
  - exact ms.
  - exact vb.
  - split; [cbn; lra |]. split; [cbn; lra |]. exists 4. apply (round_valid 4 4 (1 / 4) (1 / 100)); lra.
  - constructor.
    + exact mt.
    + split; intros u x y lo ? ?; cbn in *; pose proof (forwards t w mt x); rewrite (wb x y) by lra; cases; lra.
    + intros i hi. apply (world_known k t w); [split; reflexivity | exact hi].
    + (* Where the ego leads by the band it would have to be ahead. *)
      intros zz [<- | []] _ T u lo le ? near _ _. exists T. split; [lra |]. split; [exact near |].
      intros x y ? ? ?. cbn in *. rewrite (wb x y) by lra. pose proof (forwards t w mt x). cases; lra.
    + intros zz [<- | []] i0 i _ [].
    + intros zz [<- | []] _ [_ ahead]. exfalso. cbn in ahead. rewrite s1, t1 in ahead. lra.
    + cbn. trivial.
    + cbn. lia.
  - intros i hi. right; right; left. exists 1%nat. split; [lia |]. split; [| intros; apply world_carries].
    right. cbn [lane wide]. left.
    assert (R : rests k (departs_at k (world_log k s v) (world_commands k) 1) O <= 2).
    { unfold rests, departs_at, departure, world_log, world_commands, rest_of, shortest_period, switching, k, round. cbn.
      rewrite v1. evaluate. lra. }
    assert (B : behind k wide (ego_at (world_log k s v) 1) (world_view k t w tt 1) = 2 / 100 + 2).
    { unfold behind, world_log, world_view, earliest_rest, sensed, start, k, round. cbn. rewrite s1, t1, w1. cbn.
      destruct (Rlt_dec _ 0) as [n | _]; [exfalso; lra |]. evaluate. lra. }
    unfold stops, stops_short. change (goes (world_log k s v) 1) with O. rewrite B. cbn [slack k round]. lra.
Qed.
