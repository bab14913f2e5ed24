(* Motion: a place whose derivative is the speed, and bounds on the speed that bound the place.
   Nothing is assumed of accelerations but how much the speed changes in a time. *)
Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

(* D1 Motion: the speed is never negative. *)
Record motion (s v : R -> R) : Prop := {
  moves : forall t, is_derive s t (v t);
  forwards : forall t, 0 <= v t
}.

(* From t1 to t2 the acceleration is at most a, and who comes to rest stays there. *)
Definition speeds_up_at_most (v : R -> R) (a t1 t2 : R) :=
  forall t t', t1 <= t -> t <= t' -> t' <= t2 -> v t' <= Rmax 0 (v t + a * (t' - t)).

(* From t1 to t2 the acceleration is at least a; who is at the speed cap or above may do without accelerating. *)
Definition speeds_up_at_least (v : R -> R) (a cap t1 t2 : R) :=
  forall t t', t1 <= t -> t <= t' -> t' <= t2 -> Rmin (v t + a * (t' - t)) (Rmax cap (v t)) <= v t'.

Lemma Rmax_spec a b : (a <= b /\ Rmax a b = b) \/ (b <= a /\ Rmax a b = a).
Proof. destruct (Rle_dec a b); [left | right]; split; try lra; [apply Rmax_right | apply Rmax_left]; lra. Qed.

Lemma Rmin_spec a b : (a <= b /\ Rmin a b = a) \/ (b <= a /\ Rmin a b = b).
Proof. destruct (Rle_dec a b); [left | right]; split; try lra; [apply Rmin_left | apply Rmin_right]; lra. Qed.

(* Every minimum and maximum becomes one of its two, innermost first. *)
Ltac case_of e :=
  match e with
  | context [Rmax ?a ?b] => first [case_of a | case_of b | destruct (Rmax_spec a b) as [[? ->]|[? ->]]]
  | context [Rmin ?a ?b] => first [case_of a | case_of b | destruct (Rmin_spec a b) as [[? ->]|[? ->]]]
  end.
Ltac cases := repeat match goal with |- ?e => case_of e end.

(* The place differs from another function no more at the end than at the beginning, if the speed is below its derivative. *)
Lemma below_by_derivative s v f f' t1 t2 :
  motion s v -> t1 <= t2 ->
  (forall t, t1 <= t <= t2 -> is_derive f t (f' t)) ->
  (forall t, t1 <= t <= t2 -> v t <= f' t) ->
  s t2 - s t1 <= f t2 - f t1.
Proof.
  intros [ds _] le df below.
  destruct (MVT_gen (fun t => f t - s t) t1 t2 (fun t => f' t - v t)) as (c & [lo hi] & eq).
  - intros t [lo hi]. rewrite Rmin_left in lo by lra. rewrite Rmax_right in hi by lra.
    apply (is_derive_minus f s); [apply df; lra | apply ds].
  - intros t [lo hi]. rewrite Rmin_left in lo by lra. rewrite Rmax_right in hi by lra.
    apply continuity_pt_filterlim, (ex_derive_continuous (fun t => f t - s t)).
    exists (f' t - v t). apply (is_derive_minus f s); [apply df; lra | apply ds].
  - rewrite Rmin_left in lo by lra. rewrite Rmax_right in hi by lra.
    assert (0 <= (f' c - v c) * (t2 - t1)).
    { apply Rmult_le_pos; [| lra]. specialize (below c). lra. }
    lra.
Qed.

Lemma above_by_derivative s v f f' t1 t2 :
  motion s v -> t1 <= t2 ->
  (forall t, t1 <= t <= t2 -> is_derive f t (f' t)) ->
  (forall t, t1 <= t <= t2 -> f' t <= v t) ->
  f t2 - f t1 <= s t2 - s t1.
Proof.
  intros [ds _] le df above.
  destruct (MVT_gen (fun t => s t - f t) t1 t2 (fun t => v t - f' t)) as (c & [lo hi] & eq).
  - intros t [lo hi]. rewrite Rmin_left in lo by lra. rewrite Rmax_right in hi by lra.
    apply (is_derive_minus s f); [apply ds | apply df; lra].
  - intros t [lo hi]. rewrite Rmin_left in lo by lra. rewrite Rmax_right in hi by lra.
    apply continuity_pt_filterlim, (ex_derive_continuous (fun t => s t - f t)).
    exists (v t - f' t). apply (is_derive_minus s f); [apply ds | apply df; lra].
  - rewrite Rmin_left in lo by lra. rewrite Rmax_right in hi by lra.
    assert (0 <= (v c - f' c) * (t2 - t1)).
    { apply Rmult_le_pos; [| lra]. specialize (above c). lra. }
    lra.
Qed.

Lemma derive_quadratic p q t1 t :
  is_derive (fun u => p * (u - t1) + q * (u - t1) * (u - t1) / 2) t (p + q * (t - t1)).
Proof. auto_derive; [trivial | field]. Qed.

(* Under a speed that changes steadily, a place changes by the mean speed. *)
Lemma below_line s v p q t1 t2 :
  motion s v -> t1 <= t2 ->
  (forall t, t1 <= t <= t2 -> v t <= p + q * (t - t1)) ->
  s t2 - s t1 <= p * (t2 - t1) + q * (t2 - t1) * (t2 - t1) / 2.
Proof.
  intros m le below.
  pose proof (below_by_derivative s v _ _ t1 t2 m le (fun t _ => derive_quadratic p q t1 t) below) as H.
  simpl in H. lra.
Qed.

Lemma above_line s v p q t1 t2 :
  motion s v -> t1 <= t2 ->
  (forall t, t1 <= t <= t2 -> p + q * (t - t1) <= v t) ->
  p * (t2 - t1) + q * (t2 - t1) * (t2 - t1) / 2 <= s t2 - s t1.
Proof.
  intros m le above.
  pose proof (above_by_derivative s v _ _ t1 t2 m le (fun t _ => derive_quadratic p q t1 t) above) as H.
  simpl in H. lra.
Qed.

(* Nobody moves backwards. *)
Lemma advances s v t1 t2 : motion s v -> t1 <= t2 -> s t1 <= s t2.
Proof.
  intros m le. pose proof (above_line s v 0 0 t1 t2 m le) as H.
  assert (0 * (t2 - t1) + 0 * (t2 - t1) * (t2 - t1) / 2 <= s t2 - s t1).
  { apply H. intros. pose proof (forwards s v m t). lra. }
  lra.
Qed.

(* Of two, the one that is faster all the time gets farther. *)
Lemma gap_opens s v t w t1 t2 :
  motion s v -> motion t w -> t1 <= t2 ->
  (forall u, t1 <= u <= t2 -> w u <= v u) -> t t2 - t t1 <= s t2 - s t1.
Proof.
  intros ms mt le slower.
  apply (below_by_derivative t w s v); auto. intros u _. apply (moves s v ms).
Qed.

(* Places are continuous: who gets from here to there is at every place between at some time. *)
Lemma passes s v t1 t2 place :
  motion s v -> t1 <= t2 -> s t1 <= place <= s t2 -> exists t, t1 <= t <= t2 /\ s t = place.
Proof.
  intros m le [lo hi].
  destruct (Req_dec t1 t2) as [-> | ne]; [exists t2; split; lra |].
  destruct (IVT_gen s t1 t2 place) as (t & [a b] & eq).
  - intros t. apply continuity_pt_filterlim, (ex_derive_continuous s). exists (v t). apply (moves s v m).
  - rewrite Rmin_left, Rmax_right by lra. lra.
  - rewrite Rmin_left in a by lra. rewrite Rmax_right in b by lra. exists t. split; [lra | exact eq].
Qed.

(* Bounds on a shorter time are bounds. *)
Lemma at_most_within v a t1 t2 u1 u2 :
  t1 <= u1 -> u2 <= t2 -> speeds_up_at_most v a t1 t2 -> speeds_up_at_most v a u1 u2.
Proof. intros ? ? H t t' ? ? ?. apply H; lra. Qed.

Lemma at_least_within v a cap t1 t2 u1 u2 :
  t1 <= u1 -> u2 <= t2 -> speeds_up_at_least v a cap t1 t2 -> speeds_up_at_least v a cap u1 u2.
Proof. intros ? ? H t t' ? ? ?. apply H; lra. Qed.

(* One bound after another with the same number is one bound. *)
Lemma at_most_join v a t1 t2 t3 :
  (forall t, 0 <= v t) ->
  speeds_up_at_most v a t1 t2 -> speeds_up_at_most v a t2 t3 -> speeds_up_at_most v a t1 t3.
Proof.
  intros pos H1 H2 t t' lo le hi. pose proof (pos t). pose proof (pos t2).
  destruct (Rle_dec t' t2); [apply H1; lra |].
  destruct (Rle_dec t2 t); [apply H2; lra |].
  pose proof (H1 t t2 ltac:(lra) ltac:(lra) ltac:(lra)) as A.
  pose proof (H2 t2 t' ltac:(lra) ltac:(lra) ltac:(lra)) as B.
  revert A B. cases; intros; try lra; nra.
Qed.

Lemma at_most_weaken v a a' t1 t2 :
  a <= a' -> speeds_up_at_most v a t1 t2 -> speeds_up_at_most v a' t1 t2.
Proof.
  intros le H t t' ? ? ?. apply Rle_trans with (1 := H t t' ltac:(lra) ltac:(lra) ltac:(lra)).
  apply Rle_max_compat_l. assert (a * (t' - t) <= a' * (t' - t)) by (apply Rmult_le_compat_r; lra). lra.
Qed.

Lemma at_least_weaken v a a' cap t1 t2 :
  a' <= a -> speeds_up_at_least v a cap t1 t2 -> speeds_up_at_least v a' cap t1 t2.
Proof.
  intros le H t t' ? ? ?. apply Rle_trans with (2 := H t t' ltac:(lra) ltac:(lra) ltac:(lra)).
  apply Rle_min_compat_r. assert (a' * (t' - t) <= a * (t' - t)) by (apply Rmult_le_compat_r; lra). lra.
Qed.
